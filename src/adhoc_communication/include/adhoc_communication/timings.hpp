// RFC 3561 section 10: the constants of AODV. Derived ones are computed. HELLO_INTERVAL, TTL_START and TTL_INCREMENT
// are options of their own, with the contract's names.
#pragma once

#include <algorithm>
#include <chrono>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

struct Timings {
  Time active_route_timeout;
  Time node_traversal_time;
  Time route_request_wait;  ///< for the reply to a request of full reach; the RFC takes net_traversal_time()
  Time delete_period;
  Time shortest_memory;    ///< of requests, where path_discovery_time() is less
  int allowed_hello_loss;  ///< intervals of silence that end the routes over a neighbour
  int request_retries;     ///< RREQ_RETRIES
  int request_rate_limit = 10;
  int error_rate_limit = 10;
  int timeout_buffer = 2;
  int net_diameter = 35;
  int ttl_threshold = 7;  ///< the expanding ring goes beyond it at once as far as allowed
  int local_add_ttl = 2;
  bool destination_only = false;   ///< flag D of all own requests: only the destination answers
  bool directed_requests = false;  ///< the first request of a search goes the way that life signs come

  Time net_traversal_time() const { return 2 * net_diameter * node_traversal_time; }
  Time path_discovery_time() const { return std::max(2 * net_traversal_time(), shortest_memory); }
  Time my_route_timeout() const { return 2 * active_route_timeout; }
  Time next_hop_wait() const { return node_traversal_time + std::chrono::milliseconds(10); }
  Time blacklist_timeout() const { return request_retries * net_traversal_time(); }
  Time ring_traversal_time(int hop_limit) const { return 2 * (hop_limit + timeout_buffer) * node_traversal_time; }
  int max_repair_ttl() const { return 3 * net_diameter / 10; }
};

/// The values of section 10, with the 10 s that it asks for where the link layer reports losses.
inline Timings rfc3561_timings() {
  using namespace std::chrono_literals;
  return {10s, 40ms, 2800ms, 50s, 0s, 2, 2};
}

/// Scaled for a team of robots: an absent destination is given up after 120 + 240 + 480 + 960 ms = 1.8 s.
/// PATH_DISCOVERY_TIME counts on NODE_TRAVERSAL_TIME for each hop. On a crowded channel copies of a request are under
/// way for seconds, and one that was forgotten meanwhile would be flooded anew, again and again.
/// In a team where everybody talks to everybody, half of it could answer each request: that would be more frames than
/// to reach the destination itself, whose answer is also the newest.
inline Timings robot_timings() {
  using namespace std::chrono_literals;
  Timings timings{10s, 5ms, 120ms, 15s, 10s, 8, 3};
  timings.destination_only = true;
  timings.directed_requests = true;
  return timings;
}

}  // namespace adhoc_communication
