// Which queue of the radio each frame is for.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "host.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

/// Users' messages of the priorities control and position waited behind other traffic as maps do.
TEST(ControlFrames, AccessCategoriesFollowPriorities) {
  Stage stage;
  Host& neighbor = stage.neighbor(1);
  stage.run_for(50ms);
  for (const Priority priority : {Priority::kControl, Priority::kPosition, Priority::kNormal, Priority::kBulk}) {
    stage.team.send(0, neighbor.name, Bytes(100), priority);
    stage.team.send(0, "", Bytes(100), priority);
  }
  stage.team.send(0, "nobody", Bytes(100));
  stage.team.broadcast(0, {"topic", 'A', Bytes(100), 1});
  stage.run_for(300ms);
  std::map<FrameType, std::multiset<AccessCategory>> categories;
  std::map<Priority, std::set<AccessCategory>> of_data;
  for (const auto& [at, frame] : stage.frames()) {
    const auto type = static_cast<FrameType>(frame.bytes[1]);
    categories[type].insert(frame.category);
    if (type != FrameType::kData) continue;
    const auto data = wire::read_data(wire::open_body(frame.bytes).value());
    of_data[static_cast<Priority>(data->stream)].insert(frame.category);
  }
  const std::set<AccessCategory> best_effort{AccessCategory::kBestEffort};
  EXPECT_EQ(of_data[Priority::kControl], std::set<AccessCategory>{AccessCategory::kVoice});
  EXPECT_EQ(of_data[Priority::kPosition], std::set<AccessCategory>{AccessCategory::kVideo});
  EXPECT_EQ(of_data[Priority::kNormal], best_effort);
  EXPECT_EQ(of_data[Priority::kBulk], best_effort);
  const std::multiset<AccessCategory> each{AccessCategory::kVoice, AccessCategory::kVideo, AccessCategory::kBestEffort,
                                           AccessCategory::kBestEffort};
  EXPECT_EQ(categories[FrameType::kBroadcastData], each);
  EXPECT_EQ(categories[FrameType::kFlood], std::multiset<AccessCategory>{AccessCategory::kBestEffort});
  for (const FrameType type : {FrameType::kBeacon, FrameType::kRouteRequest}) {
    EXPECT_GT(categories[type].size(), 0u);
    EXPECT_EQ(categories[type].count(AccessCategory::kVoice), categories[type].size());
  }
}

}  // namespace
}  // namespace adhoc_communication
