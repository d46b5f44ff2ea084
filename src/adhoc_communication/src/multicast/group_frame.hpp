// A frame with a part of a group packet.
#pragma once

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::multicast {

/// For all in reach, or for one of the children.
struct GroupFrame {
  MacAddress destination{};
  Bytes body;
  bool again = false;  ///< it replaces frames that were lost
};

}  // namespace adhoc_communication::multicast
