// Frames in a file that Wireshark reads: pcap with nanosecond timestamps, link type Ethernet.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "adhoc_communication/types.hpp"
#include "link/file_descriptor.hpp"

namespace adhoc_communication {

/// A thread of its own writes, so that whoever adds frames never waits for a disk. What the disk does not take in time,
/// or has no room for, is lost and counted. A file that is full, or was there before, is renamed to <path>.old, in
/// place of the one before.
class CaptureFile {
 public:
  static constexpr std::uint64_t kMostBuffered = 8'000'000;  ///< octets

  /// At most `most_octets` in both files together; 0 means any number in one. Throws std::invalid_argument when
  /// the file cannot be made.
  CaptureFile(std::string path, std::uint64_t most_octets);
  ~CaptureFile();

  /// `at` is Unix time.
  void add(const Frame& frame, std::chrono::nanoseconds at);

  std::uint64_t frames_written() const { return written_; }
  std::uint64_t frames_lost() const { return lost_; }

 private:
  struct Batch {
    Bytes octets;
    std::uint64_t frames = 0;
  };

  void run();
  void work();
  void write(const Batch& batch);
  void keep_former() const;
  void keep_as_old() const;
  bool begin_file();
  bool append(const Bytes& octets);

  const std::string path_;
  const std::uint64_t most_in_file_;
  FileDescriptor file_;
  std::uint64_t size_ = 0;  ///< of the file, up to its last whole record
  std::atomic<std::uint64_t> written_{0};
  std::atomic<std::uint64_t> lost_{0};

  std::mutex mutex_;
  std::condition_variable arrived_;
  Batch waiting_;
  bool stopping_ = false;
  bool ended_ = false;  ///< writing has; all further frames are lost
  std::thread thread_;
};

}  // namespace adhoc_communication
