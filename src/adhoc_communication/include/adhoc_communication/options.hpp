// Options of the engine, with the contract's names and defaults where the contract has them.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "adhoc_communication/timings.hpp"
#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

struct EngineOptions {
  std::string robot_name;
  int num_link_retrans = 10;  ///< resends of a frame on one hop; 0 switches hop-by-hop ARQ off
  int num_e2e_retrans = 10;   ///< end-to-end resends without progress before a send fails
  int num_rreq = 1;           ///< route requests at one hop limit
  int max_frame_size = 1500;  ///< octets of a data frame including the Ethernet header
  int mtu = 1500;             ///< octets the link carries behind the Ethernet header
  int hop_limit_min = 0;      ///< hop limit of the first route request; 0 is unlimited
  int hop_limit_max = 0;      ///< the expanding ring ends here
  int hop_limit_increment = 3;
  std::chrono::milliseconds beacon_interval{250};  ///< HELLO_INTERVAL; while nothing happens, up to 1 s
  Timings timings = robot_timings();
  std::size_t max_packet_size = 10'000'000;  ///< octets of payload and headers of one packet
  int nack_threshold = 10;
  bool rebuild_mc_tree = false;
  bool recursive_mc_ack = false;
  double loss_ratio = 0.0;                ///< artificial loss of received data and acknowledgment frames, 0..1
  bool join_groups_automatically = true;  ///< join mc_<robot> on learning of the robot
  std::vector<TeamKey> keys;              ///< the first seals, all of them open; none: frames are open
  bool keep_records = false;              ///< of single frames and searches, see records.hpp
};

/// Throws std::invalid_argument with one sentence that names the option, its value and the allowed range.
void validate(const EngineOptions& options);

}  // namespace adhoc_communication
