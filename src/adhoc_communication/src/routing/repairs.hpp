// RFC 3561 section 6.12: routes of others that this robot is mending.
#pragma once

#include <map>
#include <set>

#include "routing/route_table.hpp"

namespace adhoc_communication::routing {

struct Repair {
  std::set<MacAddress> precursors;  ///< who relies on the route
  std::uint8_t former_hops = 0;
};

using Repairs = std::map<MacAddress, Repair>;

/// Who waits for the mended route: the robot whose data is in hand, by destination.
using DataInHand = std::map<MacAddress, MacAddress>;

}  // namespace adhoc_communication::routing
