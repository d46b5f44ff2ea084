#include "node/service_log.hpp"

#include "node/csv_row.hpp"
#include "node/log_columns.hpp"

namespace adhoc_communication {

ServiceLog::ServiceLog(const std::string& log_path, const std::string& robot)
    : file_(log_path, robot, "services.csv", log_columns::kServices) {}

void ServiceLog::add(const std::string& service, long long time_call, long long time_result, std::size_t data_size,
                     bool succeeded) {
  file_.add(csv_row(time_result, service, time_call, time_result, data_size, succeeded));
}

}  // namespace adhoc_communication
