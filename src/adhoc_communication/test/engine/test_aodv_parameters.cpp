// The constants of AODV: A12 of docs/aodv.md.
#include <gtest/gtest.h>

#include "host.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

TEST(Constants, A12_1_TheRfcsValues) {
  const Timings timings = rfc3561_timings();
  EXPECT_EQ(timings.active_route_timeout, 10s) << "section 10, where the link layer reports losses";
  EXPECT_EQ(timings.node_traversal_time, 40ms);
  EXPECT_EQ(timings.net_diameter, 35);
  EXPECT_EQ(timings.allowed_hello_loss, 2);
  EXPECT_EQ(timings.request_retries, 2);
  EXPECT_EQ(timings.request_rate_limit, 10);
  EXPECT_EQ(timings.error_rate_limit, 10);
  EXPECT_EQ(timings.timeout_buffer, 2);
  EXPECT_EQ(timings.ttl_threshold, 7);
  EXPECT_EQ(timings.local_add_ttl, 2);
  EXPECT_FALSE(timings.destination_only);
  EXPECT_EQ(timings.net_traversal_time(), 2800ms);
  EXPECT_EQ(timings.route_request_wait, timings.net_traversal_time());
  EXPECT_EQ(timings.path_discovery_time(), 5600ms);
  EXPECT_EQ(timings.blacklist_timeout(), 5600ms);
  EXPECT_EQ(timings.next_hop_wait(), 50ms);
  EXPECT_EQ(timings.ring_traversal_time(1), 240ms);
  EXPECT_EQ(timings.max_repair_ttl(), 10);
  EXPECT_EQ(timings.delete_period, 5 * timings.active_route_timeout);
  EXPECT_EQ(timings.my_route_timeout(), 2 * timings.active_route_timeout);
  EXPECT_GE(timings.my_route_timeout(), 2 * timings.path_discovery_time());
}

TEST(Constants, A12_1_DerivedOnesFollow) {
  Timings timings = rfc3561_timings();
  timings.node_traversal_time = 10ms;
  timings.net_diameter = 10;
  timings.request_retries = 3;
  timings.active_route_timeout = 4s;
  EXPECT_EQ(timings.net_traversal_time(), 200ms);
  EXPECT_EQ(timings.path_discovery_time(), 400ms);
  EXPECT_EQ(timings.blacklist_timeout(), 600ms);
  EXPECT_EQ(timings.next_hop_wait(), 20ms);
  EXPECT_EQ(timings.ring_traversal_time(3), 100ms);
  EXPECT_EQ(timings.max_repair_ttl(), 3);
  EXPECT_EQ(timings.my_route_timeout(), 8s);
  timings.shortest_memory = 1s;
  EXPECT_EQ(timings.path_discovery_time(), 1s);
}

/// Hop limits of a search in vain, and how long it takes.
std::pair<std::vector<int>, Time> search(const EngineOptions& options) {
  Stage stage(options);
  const SendId id = stage.team.send(0, "nobody", text("x"));
  while (stage.team.finished(0, id) == nullptr && stage.now() < 60s) stage.run_for(100ms);
  std::vector<int> hop_limits;
  for (const auto& request : stage.requests()) hop_limits.push_back(request.message.hop_limit);
  return {hop_limits, stage.team.finished_at(0, id)};
}

TEST(Constants, A12_1_A4_7_ASearchScalesWithThem) {
  EngineOptions options;
  options.timings = rfc3561_timings();
  options.timings.node_traversal_time = 10ms;
  options.timings.net_diameter = 10;
  options.timings.route_request_wait = options.timings.net_traversal_time();
  EXPECT_EQ(search(options), std::pair(std::vector<int>(3, 10), Time(200ms + 400ms + 800ms)));
  options.timings.request_retries = 0;
  EXPECT_EQ(search(options), std::pair(std::vector<int>(1, 10), Time(200ms)));
  options.timings.ttl_threshold = 4;
  options.timings.timeout_buffer = 0;
  options.hop_limit_min = 2;
  options.hop_limit_increment = 1;
  options.hop_limit_max = 8;
  EXPECT_EQ(search(options), std::pair(std::vector<int>({2, 3, 4, 8}), Time(40ms + 60ms + 80ms + 200ms)));
}

TEST(Constants, A12_2_ATeamOfRobotsGivesUpWithinTwoSeconds) {
  EXPECT_EQ(search({}).second, 1800ms);
  EngineOptions rfc;
  rfc.timings = rfc3561_timings();
  EXPECT_EQ(search(rfc).second, 19600ms);
}

TEST(Constants, A12_1_A3_3_ActiveRouteTimeoutSetsTheLifeOfRoutesInUse) {
  EngineOptions options;
  options.timings.active_route_timeout = 5s;
  Stage stage(options);
  Host& a = stage.neighbor(1);
  Host& b = stage.neighbor(2);
  const Host far = make_host(100);
  stage.say(a, request_for(far, a));
  stage.say(b, reply_about(far, a), stage.self().address);
  stage.run_for(9s);
  stage.say(a, data_for(far, a), stage.self().address);
  EXPECT_EQ(stage.route(far)->expires, stage.now() + 5s);
}

TEST(Constants, A12_1_A10_2_LocalAddTtlWidensRepairs) {
  EngineOptions options;
  options.timings.local_add_ttl = 4;
  Stage stage(options);
  Host& a = stage.neighbor(1);
  Host& b = stage.neighbor(2);
  const Host far = make_host(100);
  stage.say(a, request_for(far, a));
  wire::RouteReply reply = reply_about(far, a);
  reply.hop_count = 1;
  stage.say(b, reply, stage.self().address);
  stage.run_for(50ms);
  stage.forget();
  b.beacons = b.acknowledges = false;
  stage.say(a, data_for(far, a), stage.self().address);
  stage.run_for(1s);
  ASSERT_EQ(stage.requests().size(), 1u);
  EXPECT_EQ(stage.requests()[0].message.hop_limit, 2 + 4);
}

}  // namespace
}  // namespace adhoc_communication
