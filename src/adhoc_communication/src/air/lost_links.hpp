// Frames to a neighbour go unanswered, it fell silent, or it has restarted: who has to hear of it.
#pragma once

#include "multicast/distributor.hpp"
#include "transport/forwarder.hpp"

namespace adhoc_communication::air {

class LostLinks {
 public:
  LostLinks(transport::Forwarder& forwarder, multicast::Distributor& distributor)
      : forwarder_(forwarder), distributor_(distributor) {}

  void lost(const MacAddress& neighbor, Time now) {
    forwarder_.link_lost(neighbor, now);
    distributor_.link_lost(neighbor, now);
  }

 private:
  transport::Forwarder& forwarder_;
  multicast::Distributor& distributor_;
};

}  // namespace adhoc_communication::air
