// The logs of the contract that come from the state of the network.
#pragma once

#include <string>

#include "node/csv_file.hpp"
#include "node/engine_host.hpp"

namespace adhoc_communication {

/// routing_table.csv: a row per change. packet_memory_consumption.csv, unicast_datalink_transmission_summary.csv and
/// multicast.csv: a row every 5 s.
class NetworkLogs {
 public:
  NetworkLogs(const std::string& log_path, const std::string& robot);

  /// To be called about once a second. `time`: Unix milliseconds.
  void add(const Snapshot& snapshot, long long time);
  std::uint64_t rows_lost() const {
    return routes_.rows_lost() + memory_.rows_lost() + unicast_.rows_lost() + multicast_.rows_lost();
  }

 private:
  void add_routes(const Snapshot& snapshot, long long time);

  CsvFile routes_;
  CsvFile memory_;
  CsvFile unicast_;
  CsvFile multicast_;
  std::string last_routes_;
  long long next_summary_ = 0;
};

}  // namespace adhoc_communication
