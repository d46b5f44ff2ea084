// services.csv of the contract: one row per service call.
#pragma once

#include <fstream>
#include <mutex>
#include <string>

namespace adhoc_communication {

class ServiceLog {
 public:
  /// Writes to <log_path>/adhoc_communication/<robot>/services.csv; an empty path means no log. Throws
  /// std::invalid_argument when the file cannot be made.
  ServiceLog(const std::string& log_path, const std::string& robot);

  /// Times in Unix milliseconds, size in octets. A full disk loses rows, nothing else.
  void add(const std::string& service, long long time_call, long long time_result, std::size_t data_size,
           bool succeeded);

 private:
  std::mutex mutex_;
  std::ofstream file_;
};

}  // namespace adhoc_communication
