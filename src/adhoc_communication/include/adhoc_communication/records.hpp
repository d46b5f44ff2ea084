// What a host may write down of single frames and of searches for routes.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// Of a route, what AODV lets a robot know: its two ends on the way from here, and its length.
struct RouteEnds {
  MacAddress next_hop{};
  MacAddress destination{};
  std::uint8_t hops = 0;  ///< 0: there is no route
};

/// A frame of an own packet to one robot has arrived there, or is given up.
struct SegmentEnded {
  SendId packet = 0;
  std::uint32_t index = 0;  ///< of the frame in the packet
  std::string destination;
  int repetitions = 0;  ///< from end to end
  Time sent{0};         ///< for the first time
  Time ended{0};
  bool delivered = false;
  RouteEnds route;
};

/// A neighbour has acknowledged a frame.
struct FramePassed {
  std::string source;   ///< robot, or its address, that the frame comes from
  MacAddress sender{};  ///< this robot
  MacAddress neighbor{};
  std::uint32_t link_sequence = 0;
  Time sent{0};  ///< for the first time
  Time acknowledged{0};
  int repetitions = 0;  ///< on this hop
};

/// A search for a route that this robot began.
struct SearchEnded {
  std::uint32_t request = 0;  ///< id of its last request
  std::string destination;
  Time began{0};
  Time ended{0};
  int requests = 0;
  int replies = 0;
  RouteEnds route;
};

/// A copy of a route request that asks for this robot.
struct RequestArrived {
  std::uint32_t request = 0;
  std::string originator;
  int copies = 0;         ///< from different neighbours, with this one
  bool answered = false;  ///< by this way
  RouteEnds back;         ///< to the originator, by the way that the copy came
};

/// A route request of another that this robot passes on.
struct RequestPassedOn {
  std::uint32_t request = 0;
  std::string originator;
  MacAddress from{};
};

struct Record {
  Time at{0};
  std::variant<SegmentEnded, FramePassed, SearchEnded, RequestArrived, RequestPassedOn> what;
};

}  // namespace adhoc_communication
