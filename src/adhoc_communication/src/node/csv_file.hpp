// A log file of the contract: a header line, then a row at a time.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "link/file_descriptor.hpp"

namespace adhoc_communication {

/// A row that the disk does not take is lost as a whole and counted; the next one is tried again. A file that is full
/// is renamed to <name>.old, in place of the one before. Callable from any thread.
class CsvFile {
 public:
  static constexpr std::int64_t kMostOctets = 50'000'000;

  /// Writes to <log_path>/adhoc_communication/<robot>/<name>; an empty log_path means no log. Throws
  /// std::invalid_argument when the file cannot be made for another reason than a full disk.
  CsvFile(const std::string& log_path, const std::string& robot, const std::string& name, std::string header,
          std::int64_t most_octets = kMostOctets);

  /// Without the end of the line.
  void add(const std::string& row);
  std::uint64_t rows_lost() const;

 private:
  bool begin_file();
  void keep_as_old() const;
  bool append(const std::string& line);

  std::string path_;
  std::string header_;
  std::int64_t most_octets_;
  mutable std::mutex mutex_;
  FileDescriptor file_;
  std::int64_t size_ = 0;
  std::uint64_t rows_lost_ = 0;
};

/// Unix time, as in all logs of the contract.
long long unix_milliseconds();

}  // namespace adhoc_communication
