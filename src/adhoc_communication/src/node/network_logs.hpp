// The logs of the contract that come from the state of the network.
#pragma once

#include <adhoc_communication/NetworkState.h>

#include <string>

#include "node/csv_file.hpp"

namespace adhoc_communication {

/// routing_table.csv: a row per change. packet_memory_consumption.csv and unicast_datalink_transmission_summary.csv: a
/// row every 5 s.
class NetworkLogs {
 public:
  NetworkLogs(const std::string& log_path, const std::string& robot);

  /// To be called about once a second.
  void add(const NetworkState& state, long long time);
  std::uint64_t rows_lost() const { return routes_.rows_lost() + memory_.rows_lost() + traffic_.rows_lost(); }

 private:
  void add_routes(const NetworkState& state, long long time);
  void add_memory(const NetworkState& state, long long time);
  void add_traffic(const NetworkState& state, long long time);

  CsvFile routes_;
  CsvFile memory_;
  CsvFile traffic_;
  std::string last_routes_;
  long long next_summary_ = 0;
};

}  // namespace adhoc_communication
