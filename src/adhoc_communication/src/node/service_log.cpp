#include "node/service_log.hpp"

#include <filesystem>
#include <stdexcept>

namespace adhoc_communication {

ServiceLog::ServiceLog(const std::string& log_path, const std::string& robot) {
  if (log_path.empty()) return;
  const auto folder = std::filesystem::path(log_path) / "adhoc_communication" / robot;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  file_.open(folder / "services.csv");
  if (!file_) throw std::invalid_argument("parameter ~log_path = " + log_path + " names no folder that can be written");
  file_ << "#time, service, time_call, time_res, data_size, return\n" << std::flush;
}

void ServiceLog::add(const std::string& service, long long time_call, long long time_result, std::size_t data_size,
                     bool succeeded) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!file_.is_open()) return;
  file_.clear();
  file_ << time_result << ", " << service << ", " << time_call << ", " << time_result << ", " << data_size << ", "
        << succeeded << '\n'
        << std::flush;
}

}  // namespace adhoc_communication
