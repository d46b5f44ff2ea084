// The logs of the contract that have a row for each frame or search.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "adhoc_communication/records.hpp"
#include "node/csv_file.hpp"

namespace adhoc_communication {

/// transport_frames.csv, unicast_link_transmission.csv, rreq_initiater.csv, rreq_receiver.csv, rreq_intermediate.csv. A
/// thread of its own writes, so that the engine never waits for a disk. What the disk does not take in time is lost and
/// counted.
class RecordLog {
 public:
  static constexpr std::size_t kMostWaiting = 50'000;  ///< records

  RecordLog(const std::string& log_path, const std::string& robot);
  ~RecordLog();

  /// Whether there is a log: otherwise add() does nothing.
  bool wanted() const { return thread_.joinable(); }
  /// Returns at once. `now`: the engine's time.
  void add(std::vector<Record> records, Time now);
  std::uint64_t rows_lost() const;

 private:
  struct Waiting {
    Record record;
    long long epoch;  ///< see row_of()
  };

  void run();
  void work();

  /// In the order of the alternatives of a record.
  std::array<CsvFile, std::variant_size_v<decltype(Record::what)>> files_;
  std::atomic<std::uint64_t> lost_{0};

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Waiting> waiting_;
  bool stopping_ = false;
  bool ended_ = false;  ///< writing has; all further records are lost
  std::thread thread_;
};

}  // namespace adhoc_communication
