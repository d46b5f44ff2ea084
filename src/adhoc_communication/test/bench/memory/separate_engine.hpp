// An engine alone in a process of its own, so that the memory of the process is the memory of the engine.
#pragma once

#include <sys/types.h>

#include <vector>

#include "adhoc_communication/engine.hpp"
#include "link/file_descriptor.hpp"

namespace adhoc_communication::bench {

class SeparateEngine {
 public:
  struct Answer {
    Time next_deadline{0};
    std::size_t resident = 0;  ///< kB now
    std::size_t peak = 0;      ///< kB at most so far
    std::vector<Frame> frames;
  };

  /// Forks; call it while this process is still small.
  SeparateEngine(const EngineOptions& options, const MacAddress& address, Time now);
  ~SeparateEngine();
  SeparateEngine(const SeparateEngine&) = delete;
  SeparateEngine& operator=(const SeparateEngine&) = delete;

  /// The engine receives the frames, is polled, and what it reports is thrown away.
  Answer step(const std::vector<Frame>& frames, Time now);

 private:
  FileDescriptor socket_;
  pid_t process_ = -1;
};

}  // namespace adhoc_communication::bench
