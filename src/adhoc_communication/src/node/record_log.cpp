#include "node/record_log.hpp"

#include <cstdio>
#include <utility>

#include "node/log_columns.hpp"
#include "node/record_rows.hpp"
#include "run_guarded.hpp"

namespace adhoc_communication {

RecordLog::RecordLog(const std::string& log_path, const std::string& robot)
    : files_{CsvFile(log_path, robot, "transport_frames.csv", log_columns::kTransportFrames),
             CsvFile(log_path, robot, "unicast_link_transmission.csv", log_columns::kLinkFrames),
             CsvFile(log_path, robot, "rreq_initiater.csv", log_columns::kSearches),
             CsvFile(log_path, robot, "rreq_receiver.csv", log_columns::kRequestsArrived),
             CsvFile(log_path, robot, "rreq_intermediate.csv", log_columns::kRequestsPassedOn)} {
  if (!log_path.empty()) thread_ = std::thread([this] { run(); });
}

RecordLog::~RecordLog() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  arrived_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void RecordLog::add(std::vector<Record> records, Time now) {
  if (!wanted()) return;
  const long long epoch = unix_milliseconds() - now / std::chrono::milliseconds(1);
  const std::lock_guard<std::mutex> lock(mutex_);
  for (Record& record : records) {
    if (ended_ || waiting_.size() >= kMostWaiting) {
      ++lost_;
    } else {
      waiting_.push_back({std::move(record), epoch});
    }
  }
  arrived_.notify_one();
}

std::uint64_t RecordLog::rows_lost() const {
  std::uint64_t lost = lost_;
  for (const CsvFile& file : files_) lost += file.rows_lost();
  return lost;
}

void RecordLog::run() {
  run_guarded(
      "logging frames", [this] { work(); },
      [this](const std::string& text) {
        std::fprintf(stderr, "%s\n", text.c_str());
        const std::lock_guard<std::mutex> lock(mutex_);
        ended_ = true;
      });
}

void RecordLog::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    arrived_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    const std::vector<Waiting> batch = std::exchange(waiting_, {});
    const bool ends = stopping_;
    lock.unlock();
    for (const auto& [record, epoch] : batch) files_[record.what.index()].add(row_of(record, epoch));
    if (ends) return;
    lock.lock();
  }
}

}  // namespace adhoc_communication
