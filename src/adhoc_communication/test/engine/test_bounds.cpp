// Tables keep their bounds, whatever is heard.
#include <gtest/gtest.h>

#include "routing/request_flood.hpp"
#include "team.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

MacAddress stranger(std::size_t number) {
  return {6, 6, 0, 0, static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number)};
}

void expect_bounds(Team& team, const std::string& when) {
  for (const TableFill& table : team.engine(0).tables()) EXPECT_LE(table.size, table.most) << table.table << when;
}

/// What a stranger sends to robot 0, or to everybody.
template <typename Message>
void hear(Team& team, std::size_t number, wire::FrameType type, const Message& message) {
  static std::uint64_t counter = 0;
  wire::FrameHeader header;
  header.type = type;
  header.sender = stranger(number);
  header.boot_id[0] = 1;
  header.counter = ++counter;
  header.next_hop = wire::kEverybody;
  const Bytes frame = wire::close_openly(header, wire::to_bytes(message));
  team.engine(0).receive({wire::kEverybody, header.sender, frame}, team.now());
}

wire::Beacon beacon(Team& team, std::size_t number) {
  wire::Beacon beacon;
  beacon.alive = 1;
  beacon.name = "stranger_" + std::to_string(number);
  beacon.heard_count = 1;
  beacon.heard.push_back({wire::neighbor_tag(wire::boot_tag(team.boot_id(0))), 0});
  return beacon;
}

wire::RouteRequest request(std::size_t originator, std::uint32_t id, const std::string& destination) {
  wire::RouteRequest request;
  request.hop_limit = 9;
  request.id = id;
  request.destination_name = destination;
  request.unknown_sequence_number = true;
  request.originator = stranger(originator);
  request.originator_sequence = id + 1;
  request.originator_boot = wire::boot_tag(BootId{1});
  request.originator_name = "stranger_" + std::to_string(originator);
  return request;
}

/// Strangers that relied on a route and left were given a link each for the news that it broke, for ever.
TEST(Bounds, NoLinksToRobotsThatAreGone) {
  Team team;
  team.add();
  for (std::size_t wave = 0; wave < 5; ++wave) {
    const std::size_t first = wave * 100;
    const std::size_t last = first + 99;
    for (std::size_t number = first; number <= last; ++number) {
      hear(team, number, wire::FrameType::kBeacon, beacon(team, number));
    }
    // All ask for the last one, which robot 0 hears itself; so all are told when it falls silent.
    for (std::size_t number = first; number < last; ++number) {
      hear(team, number, wire::FrameType::kRouteRequest,
           request(number, static_cast<std::uint32_t>(wave), "stranger_" + std::to_string(last)));
      team.run_for(1ms);
    }
    team.run_for(8s);
    expect_bounds(team, " in wave " + std::to_string(wave));
  }
  const std::vector<TableFill> tables = team.engine(0).tables();
  const auto links = std::find_if(tables.begin(), tables.end(),
                                  [](const TableFill& table) { return std::string(table.table) == "links"; });
  ASSERT_NE(links, tables.end());
  EXPECT_EQ(links->size, 0u);
}

TEST(Bounds, RequestsThatHadToMakeRoomAreNotRememberedByConfirmingThem) {
  Team team;
  team.add();
  hear(team, 0, wire::FrameType::kBeacon, beacon(team, 0));
  team.run_for(100ms);
  for (std::uint32_t id = 0; id < 3000; ++id) {
    hear(team, 0, wire::FrameType::kRouteRequest, request(1 + id % 200, id, "nobody"));
    if (id % 1100 == 0) team.run_for(5ms);
  }
  team.run_for(100ms);
  expect_bounds(team, "");
}

/// A13.1, A5.2: with PATH_DISCOVERY_TIME scaled to a quick radio, requests outlived the memory of them on a crowded one
/// and were flooded anew for as long as the channel stayed crowded; one was seen 15 s after its originator had died.
TEST(Bounds, A5_2_RequestsAreRememberedLongerThanCopiesAreUnderWay) {
  struct Nowhere : Outbox {
    void broadcast(wire::FrameType, Bytes) override {}
    void unicast(const MacAddress&, wire::FrameType, Bytes) override {}
    void unicast_once(const MacAddress&, wire::FrameType, Bytes) override {}
  } nowhere;
  const Timings timings = robot_timings();
  Random random(1);
  routing::RequestFlood flood(timings, nowhere, random);
  EXPECT_TRUE(flood.first_time(request(1, 7, "nobody"), stranger(2), 1s));
  EXPECT_FALSE(flood.first_time(request(1, 7, "nobody"), stranger(3), 10s));
  EXPECT_TRUE(flood.first_time(request(1, 7, "nobody"), stranger(3), 12s));
}

}  // namespace
}  // namespace adhoc_communication
