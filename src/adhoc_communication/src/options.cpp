#include "adhoc_communication/options.hpp"

#include <stdexcept>

#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& value, const std::string& allowed) {
  throw std::invalid_argument("parameter " + option + " is " + value + ", but has to be " + allowed);
}

void check(const char* option, long long value, long long least, long long most) {
  if (value >= least && value <= most) return;
  refuse(option, std::to_string(value), "between " + std::to_string(least) + " and " + std::to_string(most));
}

}  // namespace

void validate(const EngineOptions& options) {
  if (options.robot_name.empty() || options.robot_name.size() > wire::kLongestName) {
    refuse("robot_name", "'" + options.robot_name + "'",
           "a text of 1 to " + std::to_string(wire::kLongestName) + " octets");
  }
  check("num_link_retrans", options.num_link_retrans, 0, 1000);
  check("num_e2e_retrans", options.num_e2e_retrans, 0, 1000);
  check("num_rreq", options.num_rreq, 1, 100);
  check("max_frame_size", options.max_frame_size, 256, 2304);
  check("mtu", options.mtu, 400, 1'000'000);
  check("hop_limit_min", options.hop_limit_min, 0, 255);
  check("hop_limit_max", options.hop_limit_max, 0, 255);
  check("hop_limit_increment", options.hop_limit_increment, 1, 255);
  if (options.hop_limit_max != 0 && options.hop_limit_min > options.hop_limit_max) {
    refuse("hop_limit_min", std::to_string(options.hop_limit_min),
           "at most hop_limit_max, which is " + std::to_string(options.hop_limit_max));
  }
  check("beacon_interval", options.beacon_interval.count(), 10, 2000);
  check("max_packet_size", static_cast<long long>(options.max_packet_size), 1000, 1'000'000'000);
  check("nack_threshold", options.nack_threshold, 0, 1'000'000);
  if (!(options.loss_ratio >= 0.0 && options.loss_ratio <= 1.0)) {
    refuse("loss_ratio", std::to_string(options.loss_ratio), "between 0 and 1");
  }
}

}  // namespace adhoc_communication
