// services.csv of the contract: one row per service call.
#pragma once

#include <string>

#include "node/csv_file.hpp"

namespace adhoc_communication {

class ServiceLog {
 public:
  ServiceLog(const std::string& log_path, const std::string& robot);

  /// Times in Unix milliseconds, size in octets.
  void add(const std::string& service, long long time_call, long long time_result, std::size_t data_size,
           bool succeeded);
  std::uint64_t rows_lost() const { return file_.rows_lost(); }

 private:
  CsvFile file_;
};

}  // namespace adhoc_communication
