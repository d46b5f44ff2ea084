#include "routing/route_discovery.hpp"

#include <algorithm>

namespace adhoc_communication::routing {

RouteDiscovery::RouteDiscovery(const EngineOptions& options, Random& random)
    : timings_(options.timings),
      random_(random),
      first_ring_(options.hop_limit_min == 0 ? timings_.net_diameter
                                             : std::min(options.hop_limit_min, timings_.net_diameter)),
      last_ring_(options.hop_limit_max == 0 ? timings_.net_diameter
                                            : std::min(options.hop_limit_max, timings_.net_diameter)),
      increment_(std::max(1, options.hop_limit_increment)),
      tries_per_ring_(options.num_rreq),
      rate_limit_(timings_.request_rate_limit),
      others_limit_(std::max(1, timings_.request_rate_limit / 2)) {
  first_ring_ = std::min(first_ring_, last_ring_);
}

void RouteDiscovery::search(const Target& target, std::uint8_t last_hops, std::uint8_t told_hops, Time now) {
  if (searching(target)) {
    searches_.at(key(target)).for_others = false;
    return;
  }
  end_exchange(target);
  if (searches_.size() >= kMostSearches) {
    failures_.push_back({target, Time(0), false});
    return;
  }
  begin(target, last_hops, told_hops, false, now);
}

bool RouteDiscovery::search_for_others(const Target& target, std::uint8_t last_hops, std::uint8_t told_hops, Time now) {
  if (searching(target)) return true;
  end_exchange(target);
  if (!has_room_for_others()) return false;
  begin(target, last_hops, told_hops, true, now);
  return true;
}

void RouteDiscovery::begin(const Target& target, std::uint8_t last_hops, std::uint8_t told_hops, bool for_others,
                           Time now) {
  Search search{target, now, now, first_ring_};
  search.for_others = for_others;
  // Section 6.4: the ring for a lost route starts a little beyond its former length.
  if (last_hops > 0) search.hop_limit = std::clamp(last_hops + increment_, first_ring_, last_ring_);
  search.told_hops = told_hops;
  searches_.emplace(key(target), search);
}

bool RouteDiscovery::repair(const MacAddress& destination, int hop_limit, Time now) {
  return once(destination, hop_limit, {}, now);
}

bool RouteDiscovery::exchange(const MacAddress& destination, std::uint32_t sequence, int hop_limit, Time now) {
  return searches_.count(key({destination, {}})) == 0 && once(destination, hop_limit, sequence, now);
}

bool RouteDiscovery::once(const MacAddress& destination, int hop_limit, std::optional<std::uint32_t> newer_than,
                          Time now) {
  const Target target{destination, {}};
  if (searching(target) || !has_room_for_others() || rate_limit_.free_at(now) > now) return false;
  end_exchange(target);
  Search search{target, now, now, std::min(hop_limit, last_ring_), 0, !newer_than};
  search.newer_than = newer_than;
  search.for_others = true;
  searches_.emplace(key(target), search);
  return true;
}

bool RouteDiscovery::has_room_for_others() const {
  return searches_.size() < kMostSearches && searches_for_others() < kMostForOthers;
}

std::size_t RouteDiscovery::searches_for_others() const {
  const auto counts = [](const auto& item) { return item.second.for_others; };
  return static_cast<std::size_t>(std::count_if(searches_.begin(), searches_.end(), counts));
}

Time RouteDiscovery::free_at(const Search& search, Time now) const {
  const Time free = rate_limit_.free_at(now);
  return half_of_limit(search) ? std::max(free, others_limit_.free_at(now)) : free;
}

bool RouteDiscovery::take(const Search& search, Time now) {
  if (free_at(search, now) > now) return false;
  if (half_of_limit(search)) others_limit_.take(now);
  return rate_limit_.take(now);
}

void RouteDiscovery::end_exchange(const Target& target) {
  const auto found = searches_.find(key(target));
  if (found == searches_.end() || !found->second.newer_than) return;
  end(found->second);
  searches_.erase(found);
}

std::vector<RouteDiscovery::Step> RouteDiscovery::poll(const std::function<std::uint8_t(const Target&)>& told_hops,
                                                       Time now, const std::function<bool(const Target&)>& present) {
  std::vector<Step> steps;
  for (auto iterator = searches_.begin(); iterator != searches_.end();) {
    Search& search = iterator->second;
    if (search.due > now) {
      ++iterator;
    } else if (search.told_hops > 0) {
      steps.push_back(directed(search, now));
      ++iterator;
    } else if (!advance(search, now)) {
      const bool patient = !search.repair && !search.newer_than && now - search.started < kPatience;
      const bool may_flood = patient && !search.for_others && present(search.target);
      search.told_hops = patient && !(may_flood && search.was_directed) ? told_hops(search.target) : std::uint8_t{0};
      search.was_directed = search.told_hops > 0;
      if (search.was_directed) continue;
      search.prolonged = may_flood;
      if (search.prolonged) {
        --search.tries;
        continue;
      }
      if (!search.newer_than) failures_.push_back({search.target, now - search.started, search.repair});
      end(search);
      iterator = searches_.erase(iterator);
    } else {
      if (search.due > now) {
        steps.push_back({search.target, static_cast<std::uint8_t>(search.hop_limit), false, search.newer_than});
      } else {
        search.due = free_at(search, now);
      }
      ++iterator;
    }
  }
  return steps;
}

void RouteDiscovery::requested(const Target& target, std::uint32_t id) {
  const auto found = searches_.find(key(target));
  if (found == searches_.end()) return;
  ++found->second.requests;
  found->second.last_request = id;
}

/// The destination may have been asked for by its address or by its name.
void RouteDiscovery::replied(const Target& target) {
  for (const Key& asked : {Key{target.address, {}}, Key{{}, target.name}}) {
    if (const auto found = searches_.find(asked); found != searches_.end()) ++found->second.replies;
  }
}

RouteDiscovery::Step RouteDiscovery::directed(Search& search, Time now) const {
  const int hops = std::exchange(search.told_hops, std::uint8_t{0}) + kDetour;
  search.due = now + kDirectedPatience * timings_.ring_traversal_time(hops);
  return {search.target, static_cast<std::uint8_t>(std::min(hops, timings_.net_diameter)), true};
}

/// Takes the next try if the rate limit lets it, and sets when to look again. False when all tries are used up.
bool RouteDiscovery::advance(Search& search, Time now) {
  const bool only_once = search.repair || search.newer_than;
  if (only_once && search.tries > 0) return false;
  const bool last = !only_once && is_last_ring(search.hop_limit);
  const int most_tries = tries_per_ring_ + (last ? timings_.request_retries : 0);
  if (search.tries >= most_tries) {
    if (last) return false;
    search.hop_limit = next_ring(search.hop_limit);
    search.tries = 0;
    return advance(search, now);
  }
  if (!take(search, now)) return true;
  // Section 6.3: binary exponential backoff at full reach; section 6.4: ring traversal time before.
  // What hides a target that is present may end at any moment.
  const int doublings = std::min(search.tries, search.prolonged ? kDoublingsProlonged : 10);
  const Time wait =
      last ? timings_.route_request_wait * (1 << doublings) : timings_.ring_traversal_time(search.hop_limit);
  ++search.tries;
  const bool another_follows = !only_once && (search.prolonged || !last || search.tries < most_tries);
  const Time jitter = another_follows ? random_.delay(wait / kJitterShare) : Time(0);
  search.due = now - std::exchange(search.late, jitter) + wait + jitter;
  return true;
}

/// Section 6.4.
int RouteDiscovery::next_ring(int hop_limit) const {
  const int next = hop_limit + increment_;
  return next > timings_.ttl_threshold ? last_ring_ : std::min(next, last_ring_);
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
