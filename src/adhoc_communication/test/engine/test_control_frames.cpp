// Which frames may overtake others in the radio.
#include <gtest/gtest.h>

#include <set>

#include "host.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

TEST(ControlFrames, AreThoseWhoseOrderNobodyKeeps) {
  Stage stage;
  Host& neighbor = stage.neighbor(1);
  stage.run_for(50ms);
  stage.team.send(0, neighbor.name, Bytes(100));
  stage.team.send(0, "nobody", Bytes(100));
  stage.run_for(300ms);
  std::set<FrameType> control, others;
  for (const auto& [at, frame] : stage.frames()) {
    const bool asks_for_acknowledgment = (frame.bytes[2] & wire::kWantsAcknowledgment) != 0;
    EXPECT_FALSE(frame.control && asks_for_acknowledgment);
    (frame.control ? control : others).insert(static_cast<FrameType>(frame.bytes[1]));
  }
  EXPECT_EQ(control.count(FrameType::kBeacon), 1u);
  EXPECT_EQ(control.count(FrameType::kRouteRequest), 1u);
  EXPECT_EQ(control.count(FrameType::kData), 0u);
  EXPECT_EQ(others.count(FrameType::kData), 1u);
}

}  // namespace
}  // namespace adhoc_communication
