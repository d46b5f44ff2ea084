#include "routing/route_discovery.hpp"

#include <algorithm>

namespace adhoc_communication::routing {

RouteDiscovery::RouteDiscovery(const Timings& timings, const EngineOptions& options)
    : timings_(timings),
      first_ring_(options.hop_limit_min == 0 ? timings.net_diameter
                                             : std::min(options.hop_limit_min, timings.net_diameter)),
      last_ring_(options.hop_limit_max == 0 ? timings.net_diameter
                                            : std::min(options.hop_limit_max, timings.net_diameter)),
      increment_(std::max(1, options.hop_limit_increment)),
      tries_per_ring_(options.num_rreq),
      rate_limit_(timings.rate_limit) {
  first_ring_ = std::min(first_ring_, last_ring_);
}

void RouteDiscovery::search(const Target& target, std::uint8_t last_hops, Time now) {
  if (searching(target)) return;
  if (searches_.size() >= kMostSearches) {
    failures_.push_back({target, Time(0)});
    return;
  }
  Search search{target, now, now, first_ring_, 0};
  // Section 6.4: the ring for a lost route starts a little beyond its former length.
  if (last_hops > 0) search.hop_limit = std::clamp(last_hops + increment_, first_ring_, last_ring_);
  searches_.emplace(key(target), search);
}

std::vector<RouteDiscovery::Step> RouteDiscovery::poll(Time now) {
  std::vector<Step> steps;
  for (auto iterator = searches_.begin(); iterator != searches_.end();) {
    Search& search = iterator->second;
    if (search.due > now) {
      ++iterator;
    } else if (!advance(search, now)) {
      failures_.push_back({search.target, now - search.started});
      iterator = searches_.erase(iterator);
    } else {
      if (search.due > now) {
        steps.push_back({search.target, static_cast<std::uint8_t>(search.hop_limit)});
      } else {
        search.due = rate_limit_.free_at(now);
      }
      ++iterator;
    }
  }
  return steps;
}

/// Takes the next try if the rate limit lets it, and sets when to look again. False when all tries are used up.
bool RouteDiscovery::advance(Search& search, Time now) {
  const bool last = is_last_ring(search.hop_limit);
  const int most_tries = tries_per_ring_ + (last ? timings_.request_retries : 0);
  if (search.tries >= most_tries) {
    if (last) return false;
    search.hop_limit = std::min(search.hop_limit + increment_, last_ring_);
    search.tries = 0;
    return advance(search, now);
  }
  if (!rate_limit_.take(now)) return true;
  // Section 6.3: binary exponential backoff at full reach; section 6.4: ring traversal time before.
  const Time wait = last ? timings_.route_request_wait * (1 << std::min(search.tries, 10))
                         : timings_.ring_traversal_time(search.hop_limit);
  ++search.tries;
  search.due = now + wait;
  return true;
}

Time RouteDiscovery::next_deadline() const {
  Time next = failures_.empty() ? Time::max() : Time(0);
  for (const auto& [unused, search] : searches_) next = std::min(next, search.due);
  return next;
}

RouteDiscovery::Key RouteDiscovery::key(const Target& target) {
  return target.address == MacAddress{} ? Key{{}, target.name} : Key{target.address, {}};
}

}  // namespace adhoc_communication::routing
