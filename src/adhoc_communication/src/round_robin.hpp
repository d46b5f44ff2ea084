// Taking turns among the entries of a map.
#pragma once

#include <algorithm>

namespace adhoc_communication {

/// Visits the entries behind `last`, then those up to it, until `visit` says that this was enough. Tells whether it
/// did.
template <typename Map, typename Visit>
bool visit_after(Map& map, const typename Map::key_type& last, Visit visit) {
  const auto first = map.upper_bound(last);
  return std::any_of(first, map.end(), visit) || std::any_of(map.begin(), first, visit);
}

}  // namespace adhoc_communication
