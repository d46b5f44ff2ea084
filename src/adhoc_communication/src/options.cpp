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

std::string milliseconds_text(Time time) { return std::to_string(time / std::chrono::milliseconds(1)) + " ms"; }

void check_time(const char* option, Time value, Time least) {
  constexpr Time kMost = std::chrono::hours(1);
  if (value >= least && value <= kMost) return;
  refuse(option, milliseconds_text(value), "between " + milliseconds_text(least) + " and " + milliseconds_text(kMost));
}

void check_ranges(const Timings& timings) {
  constexpr Time kLeast = std::chrono::milliseconds(1);
  check_time("active_route_timeout", timings.active_route_timeout, kLeast);
  check_time("node_traversal_time", timings.node_traversal_time, kLeast);
  check_time("route_request_wait", timings.route_request_wait, kLeast);
  check_time("delete_period", timings.delete_period, kLeast);
  check_time("shortest_memory", timings.shortest_memory, Time(0));
  check("allowed_hello_loss", timings.allowed_hello_loss, 1, 1000);
  check("request_retries", timings.request_retries, 0, 100);
  check("request_rate_limit", timings.request_rate_limit, 1, 1'000'000);
  check("error_rate_limit", timings.error_rate_limit, 1, 1'000'000);
  check("timeout_buffer", timings.timeout_buffer, 0, 1000);
  check("net_diameter", timings.net_diameter, 1, wire::kFarthestHop);
  check("ttl_threshold", timings.ttl_threshold, 0, wire::kFarthestHop);
  check("local_add_ttl", timings.local_add_ttl, 0, wire::kFarthestHop);
}

/// RFC 3561 section 10 ties them to each other.
void check_timings(const Timings& timings, Time beacon_interval) {
  check_ranges(timings);
  const Time silence = timings.allowed_hello_loss * beacon_interval;
  if (timings.active_route_timeout <= silence) {
    refuse("active_route_timeout", milliseconds_text(timings.active_route_timeout),
           "more than the " + milliseconds_text(silence) +
               " for which a neighbour may be silent (allowed_hello_loss * beacon_interval)");
  }
  if (timings.delete_period < timings.active_route_timeout) {
    refuse("delete_period", milliseconds_text(timings.delete_period),
           "at least active_route_timeout, which is " + milliseconds_text(timings.active_route_timeout));
  }
}

}  // namespace

void validate(const EngineOptions& options) {
  if (!wire::is_name(options.robot_name)) {
    refuse("robot_name", "'" + options.robot_name + "'",
           "a text of 1 to " + std::to_string(wire::kLongestName) + " visible ASCII characters");
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
  check_timings(options.timings, options.beacon_interval);
  check("max_packet_size", static_cast<long long>(options.max_packet_size), 1000, 1'000'000'000);
  check("nack_threshold", options.nack_threshold, 0, 1'000'000);
  if (!(options.loss_ratio >= 0.0 && options.loss_ratio <= 1.0)) {
    refuse("loss_ratio", std::to_string(options.loss_ratio), "between 0 and 1");
  }
}

}  // namespace adhoc_communication
