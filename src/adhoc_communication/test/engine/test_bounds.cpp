// Tables keep their bounds, whatever is heard.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "routing/request_flood.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

void expect_bounds(Stage& stage, const std::string& when) {
  for (const TableFill& table : stage.node().tables()) EXPECT_LE(table.size, table.most) << table.table << when;
}

wire::RouteRequest request_of(const Host& originator, const std::string& destination, std::uint32_t id) {
  wire::RouteRequest request = request_for({}, originator, id);
  request.destination_name = destination;
  request.originator_sequence = id + 1;
  return request;
}

TEST(Bounds, FloodedPacketsAndWhatMembersSayOfThem) {
  Stage stage;
  Host root = make_host(0);
  Host liar = make_host(1);
  stage.beacon(root);
  stage.beacon(liar);
  wire::GroupData data;
  data.root = root.address;
  data.root_boot = root.boot();
  data.flooded = true;
  data.total = 100;
  data.segment_size = 1000;
  data.octets = Bytes(100, 1);
  for (std::size_t i = 0; i < 2000; ++i) {
    data.packet = static_cast<std::uint32_t>(i);
    stage.say(liar, data);
    wire::GroupReceipts receipts;
    for (std::size_t member = 0; member < 5; ++member) {
      receipts.receipts.push_back({root.address, root.boot(), 0, make_host(100 + 5 * i + member).address, 1, 0});
    }
    stage.say(liar, receipts);
    stage.run_for(1ms);
    if (i % 100 == 0) {
      stage.beacon(root);
      stage.beacon(liar);
    }
  }
  expect_bounds(stage, " after 2000 packets and 10 000 receipts");
  for (const TableFill& table : stage.node().tables()) {
    const bool meant = std::string(table.table) == "flooded packets" || std::string(table.table) == "receipts";
    if (meant) EXPECT_EQ(table.size, table.most) << table.table << ": the test does not fill it";
  }
}

/// Strangers that relied on a route and left were given a link each for the news that it broke, for ever.
TEST(Bounds, NoLinksToRobotsThatAreGone) {
  Stage stage;
  for (std::size_t wave = 0; wave < 5; ++wave) {
    std::vector<Host> strangers;
    for (std::size_t i = 0; i < 100; ++i) strangers.push_back(make_host(wave * 100 + i));
    for (Host& stranger : strangers) stage.beacon(stranger);
    // All ask for the last one, which the node hears itself; so all are told when it falls silent.
    for (std::size_t i = 0; i < 99; ++i) {
      stage.say(strangers[i], request_of(strangers[i], strangers[99].name, static_cast<std::uint32_t>(wave)));
      stage.run_for(1ms);
    }
    stage.run_for(8s);
    expect_bounds(stage, " in wave " + std::to_string(wave));
  }
  const std::vector<TableFill> tables = stage.node().tables();
  const auto links = std::find_if(tables.begin(), tables.end(),
                                  [](const TableFill& table) { return std::string(table.table) == "links"; });
  ASSERT_NE(links, tables.end());
  EXPECT_EQ(links->size, 0u);
}

TEST(Bounds, RequestsThatHadToMakeRoomAreNotRememberedByConfirmingThem) {
  Stage stage;
  Host& stranger = stage.neighbor(0);
  stage.run_for(100ms);
  for (std::uint32_t id = 0; id < 3000; ++id) {
    stage.say(stranger, request_of(make_host(1 + id % 200), "nobody", id));
    if (id % 1100 == 0) stage.run_for(5ms);
  }
  stage.run_for(100ms);
  expect_bounds(stage, "");
}

/// With PATH_DISCOVERY_TIME scaled to a quick radio, requests outlived the memory of them on a crowded one
/// and were flooded anew for as long as the channel stayed crowded; one was seen 15 s after its originator had died.
TEST(Bounds, A5_2_RequestsAreRememberedLongerThanCopiesAreUnderWay) {
  struct Nowhere : Outbox {
    void broadcast(wire::FrameType, Bytes, Time) override {}
    void unicast(const MacAddress&, wire::FrameType, Bytes) override {}
    void unicast_once(const MacAddress&, wire::FrameType, Bytes, Time) override {}
  } nowhere;
  const Timings timings = robot_timings();
  Random random(1);
  routing::RequestFlood flood(timings, true, nowhere, random);
  EXPECT_TRUE(flood.first_time(request_of(make_host(1), "nobody", 7), make_host(2).address, 1s));
  EXPECT_FALSE(flood.first_time(request_of(make_host(1), "nobody", 7), make_host(3).address, 10s));
  EXPECT_TRUE(flood.first_time(request_of(make_host(1), "nobody", 7), make_host(3).address, 12s));
}

}  // namespace
}  // namespace adhoc_communication
