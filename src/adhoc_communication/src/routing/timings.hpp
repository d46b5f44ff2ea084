// RFC 3561 section 10: the constants of AODV. Derived ones are computed.
#pragma once

#include <chrono>
#include <cstdint>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::routing {

struct Timings {
  Time active_route_timeout;
  Time node_traversal_time;
  Time route_request_wait;  ///< for the reply to a request of full reach; the RFC takes net_traversal_time()
  Time delete_period;
  Time neighbor_timeout;  ///< silence after which routes over a neighbour end: ALLOWED_HELLO_LOSS * HELLO_INTERVAL
  int request_retries;    ///< RREQ_RETRIES
  int timeout_buffer = 2;
  int net_diameter = 35;
  int rate_limit = 10;  ///< RREQ_RATELIMIT and RERR_RATELIMIT, per second

  Time net_traversal_time() const { return 2 * net_diameter * node_traversal_time; }
  Time path_discovery_time() const { return 2 * net_traversal_time(); }
  Time my_route_timeout() const { return 2 * active_route_timeout; }
  Time ring_traversal_time(int hop_limit) const { return 2 * (hop_limit + timeout_buffer) * node_traversal_time; }
};

/// The values of section 10, with the 10 s that it asks for where the link layer reports losses.
inline Timings rfc3561_timings() {
  using namespace std::chrono_literals;
  return {10s, 40ms, 2800ms, 50s, 2s, 2};
}

/// Scaled for a team of robots: an absent destination is given up after 120 + 240 + 480 + 960 ms = 1.8 s.
inline Timings robot_timings() {
  using namespace std::chrono_literals;
  return {10s, 5ms, 120ms, 15s, 2s, 3};
}

}  // namespace adhoc_communication::routing
