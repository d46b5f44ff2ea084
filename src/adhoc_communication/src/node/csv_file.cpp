#include "node/csv_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace adhoc_communication {

CsvFile::CsvFile(const std::string& log_path, const std::string& robot, const std::string& name, std::string header,
                 std::int64_t most_octets)
    : header_(std::move(header)), most_octets_(most_octets) {
  if (log_path.empty()) return;
  const auto folder = std::filesystem::path(log_path) / "adhoc_communication" / robot;
  path_ = folder / name;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::error_code unknown;
  if (std::filesystem::symlink_status(path_, unknown).type() == std::filesystem::file_type::regular) keep_as_old();
  if (!begin_file() && errno != ENOSPC && errno != EDQUOT && error != std::errc::no_space_on_device) {
    throw std::invalid_argument("parameter ~log_path = " + log_path + " names no folder that can be written");
  }
}

void CsvFile::add(const std::string& row) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (path_.empty()) return;
  if (file_.is_open() && size_ + static_cast<std::int64_t>(row.size()) + 1 > most_octets_) {
    file_.reset();
    keep_as_old();
  }
  const bool written = (file_.is_open() || begin_file()) && append(row + "\n");
  if (!written) ++rows_lost_;
}

std::uint64_t CsvFile::rows_lost() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return rows_lost_;
}

void CsvFile::keep_as_old() const { std::rename(path_.c_str(), (path_ + ".old").c_str()); }

bool CsvFile::begin_file() {
  FileDescriptor file(open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644));
  if (!file.is_open()) return false;
  file_ = std::move(file);
  size_ = 0;
  if (append(header_ + "\n")) return true;
  const int reason = errno;
  file_.reset();
  errno = reason;
  return false;
}

bool CsvFile::append(const std::string& line) {
  const ssize_t written = write(file_.get(), line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size())) {
    size_ += written;
    return true;
  }
  const int reason = written < 0 ? errno : ENOSPC;
  if (written > 0 && ftruncate(file_.get(), size_) != 0) file_.reset();
  errno = reason;
  return false;
}

long long unix_milliseconds() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

}  // namespace adhoc_communication
