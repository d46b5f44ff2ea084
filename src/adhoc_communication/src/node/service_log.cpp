#include "node/service_log.hpp"

#include <sstream>

namespace adhoc_communication {

ServiceLog::ServiceLog(const std::string& log_path, const std::string& robot)
    : file_(log_path, robot, "services.csv", "#time, service, time_call, time_res, data_size, return") {}

void ServiceLog::add(const std::string& service, long long time_call, long long time_result, std::size_t data_size,
                     bool succeeded) {
  std::ostringstream row;
  row << time_result << ", " << service << ", " << time_call << ", " << time_result << ", " << data_size << ", "
      << succeeded;
  file_.add(row.str());
}

}  // namespace adhoc_communication
