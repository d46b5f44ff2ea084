// What other threads want done by the thread of the engine.
#pragma once

#include <deque>
#include <functional>
#include <mutex>

#include "adhoc_communication/types.hpp"
#include "link/file_descriptor.hpp"

namespace adhoc_communication {

/// Each command that was accepted is run or fails, so that nobody waits in vain. Callable from any thread, but for
/// run() and fail().
class Commands {
 public:
  /// `fail` comes instead of `run`, or after it, if that has thrown.
  struct Command {
    std::function<void(Time now)> run;
    std::function<void()> fail;
  };

  Commands();

  /// False when they are closed.
  bool post(Command command);
  /// No further ones are accepted.
  void close();
  bool closed() const;
  /// Readable when something was posted, or they were closed.
  int descriptor() const { return news_.get(); }

  /// Runs those posted, in order. If one throws, it and those behind it are left.
  void run(Time now);
  /// Fails those left, whatever they throw.
  void fail();

 private:
  void take();

  FileDescriptor news_;
  std::deque<Command> taken_;  ///< not finished yet; of the thread
  mutable std::mutex mutex_;
  std::deque<Command> posted_;
  bool closed_ = false;
};

}  // namespace adhoc_communication
