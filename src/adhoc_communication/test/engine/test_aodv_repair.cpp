// Local repair and restarts: A10 and A11 of docs/aodv.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "host.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

/// Source ... a - node - b ... destination, of which b falls silent with data in hand.
struct Break : Stage {
  explicit Break(int hops, int hops_back = 2) : a(neighbor(1)), b(neighbor(2)), c(neighbor(3)) {
    run_for(50ms);
    open_way(kFar, hops, hops_back);
  }
  void open_way(const Host& destination, int hops, int hops_back = 2) {
    wire::RouteRequest request = request_for(destination, kSource, ++id);
    request.originator_sequence = id;
    request.hop_count = static_cast<std::uint8_t>(hops_back - 1);
    say(a, request);
    wire::RouteReply reply = reply_about(destination, kSource);
    reply.hop_count = static_cast<std::uint8_t>(hops - 1);
    reply.cost = static_cast<std::uint16_t>(16 * (hops - 1));
    say(b, reply, self().address);
    run_for(5ms);
    forget();
  }
  void pass_on(const Host& destination) { say(a, data_for(destination, kSource, ++packet), self().address); }
  /// Until the link is found dead: 150 ms of silence with data outstanding.
  void lose_b() {
    b.beacons = b.acknowledges = false;
    pass_on(kFar);
    while (route(b) && now() < 5s) run_for(1ms);
    run_for(1ms);
  }
  Host& a;
  Host& b;
  Host& c;
  std::uint32_t id = 0;
  std::uint32_t packet = 0;
};

TEST(LocalRepair, A10_1_OnlyNearTheDestination) {
  EXPECT_EQ(rfc3561_timings().max_repair_ttl(), 10);
  Break near(10);
  near.lose_b();
  EXPECT_EQ(near.requests().size(), 1u);
  for (const auto& error : near.sent<wire::RouteError>()) {
    for (const auto& lost : error.message.destinations) EXPECT_NE(lost.address, kFar.address);
  }
  Break far(11);
  far.lose_b();
  EXPECT_TRUE(far.requests().empty());
  ASSERT_EQ(far.sent<wire::RouteError>().size(), 1u);
  EXPECT_EQ(far.sent<wire::RouteError>()[0].to, far.a.address);
}

/// The request that repairs a route of so many hops, at so many from the source.
wire::RouteRequest repairing_request(int hops, int hops_back) {
  Break broken(hops, hops_back);
  const std::uint32_t before = broken.entry(kFar)->sequence;
  broken.lose_b();
  EXPECT_EQ(broken.requests().size(), 1u);
  const wire::RouteRequest request = broken.requests().at(0).message;
  EXPECT_FALSE(request.unknown_sequence_number);
  EXPECT_EQ(request.destination_sequence, before + 1);
  return request;
}

TEST(LocalRepair, A10_2_TheRequestGoesALittleFartherThanTheDestinationWas) {
  EXPECT_EQ(repairing_request(2, 1).hop_limit, 2 + 2);
  EXPECT_EQ(repairing_request(5, 4).hop_limit, 5 + 2);
  EXPECT_EQ(repairing_request(2, 8).hop_limit, 4 + 2) << "half of the way back";
}

TEST(LocalRepair, A10_3_DataWaitsForTheRepair) {
  Break broken(2);
  broken.lose_b();
  broken.pass_on(kFar);
  broken.run_for(5ms);
  broken.forget();
  Host far = kFar;
  far.sequence = broken.entry(kFar)->sequence;
  broken.say(broken.c, reply_about(far, broken.self()), broken.self().address);
  broken.run_for(5ms);
  const auto data = broken.sent<wire::Data>();
  ASSERT_EQ(data.size(), 2u);
  for (const auto& sent : data) EXPECT_EQ(sent.to, broken.c.address);
  broken.run_for(1s);
  EXPECT_EQ(broken.count(FrameType::kRouteError), 0u) << "one hop less than before: nobody has to know";
}

TEST(LocalRepair, A10_3_FailureIsAnnouncedToWhoRelyOnTheRoute) {
  Break broken(2);
  broken.lose_b();
  broken.forget();
  broken.run_for(1s);
  ASSERT_EQ(broken.sent<wire::RouteError>().size(), 1u);
  EXPECT_EQ(broken.sent<wire::RouteError>()[0].to, broken.a.address);
  EXPECT_EQ(broken.sent<wire::RouteError>()[0].message.destinations.at(0).address, kFar.address);
  EXPECT_FALSE(broken.sent<wire::RouteError>()[0].message.no_delete);
  EXPECT_TRUE(broken.requests().empty()) << "one request, and no more";
}

TEST(LocalRepair, A10_4_AnswersThatMakeTheRouteLongerAreTold) {
  for (const int hops : {2, 3}) {
    Break broken(2);
    broken.lose_b();
    broken.forget();
    wire::RouteReply reply = reply_about(kFar, broken.self());
    reply.destination_sequence = broken.entry(kFar)->sequence;
    reply.hop_count = static_cast<std::uint8_t>(hops - 1);
    broken.say(broken.c, reply, broken.self().address);
    broken.run_for(5ms);
    const auto errors = broken.sent<wire::RouteError>();
    ASSERT_EQ(errors.size(), hops == 2 ? 0u : 1u);
    if (hops == 2) continue;
    EXPECT_EQ(errors[0].to, broken.a.address);
    EXPECT_TRUE(errors[0].message.no_delete);
  }
}

TEST(LocalRepair, A10_5_OtherRoutesAreRepairedWhenDataComesForThem) {
  Break broken(2);
  const Host second = make_host(200);
  const Host third = make_host(201);
  broken.open_way(second, 2);
  broken.open_way(third, 2);
  broken.lose_b();
  ASSERT_EQ(broken.requests().size(), 1u);
  EXPECT_EQ(broken.requests()[0].message.destination, kFar.address);
  for (const Host& other : {second, third}) {
    EXPECT_FALSE(broken.entry(other)->valid);
    EXPECT_TRUE(broken.entry(other)->repairable);
  }
  broken.forget();
  broken.pass_on(second);
  broken.run_for(1ms);
  ASSERT_EQ(broken.requests().size(), 1u);
  EXPECT_EQ(broken.requests()[0].message.destination, second.address);
}

/// Numbers of a former run mean nothing: what a restarted robot needs is that its own new run is told from it.
TEST(Restart, A11_3_A11_4_TheNumberAskedForIsTakenOverAfterARestart) {
  Stage stage;
  Host& a = stage.neighbor(1);
  stage.run_for(10ms);
  wire::RouteRequest request = request_for(stage.self(), a);
  request.unknown_sequence_number = false;
  request.destination_sequence = 77;
  stage.say(a, request);
  stage.run_for(5ms);
  ASSERT_EQ(stage.sent<wire::RouteReply>().size(), 1u);
  EXPECT_EQ(stage.sent<wire::RouteReply>()[0].message.destination_sequence, 77u);
  EXPECT_EQ(stage.sent<wire::RouteReply>()[0].message.destination_boot, stage.self().boot());
}

/// Answers from tables could lead back by way of the former run of whoever asks.
TEST(Restart, A11_4_FirstOnlyDestinationsAnswer) {
  EngineOptions options;
  options.timings.destination_only = false;
  Stage stage(options);
  stage.neighbor(1);
  stage.run_for(10ms);
  stage.team.send(0, "nobody", text("x"));
  stage.run_for(10ms);
  EXPECT_TRUE(stage.requests().at(0).message.destination_only);
  stage.run_for(robot_timings().delete_period);
  stage.forget();
  stage.team.send(0, "nobody", text("x"));
  stage.run_for(10ms);
  EXPECT_FALSE(stage.requests().at(0).message.destination_only);
}

/// A ring of 4: 0 - 1 - 2 - 3 - 0.
void add_ring(Team& team) {
  team.add({}, 0, 0);
  team.add({}, 8, 0);
  team.add({}, 8, 8);
  team.add({}, 0, 8);
}

/// How often each robot of a team took each segment from another robot than before: going in circles, or hither and
/// thither, brings a segment back to a robot that has passed it on.
class Trail {
 public:
  explicit Trail(Team& team) : team_(team) {
    team.on_frame = [this](Medium::Node node, const Frame& frame) { take(node, frame); };
  }
  std::size_t segments() const { return passed_.size(); }
  std::vector<std::string> returns;  ///< what should not have happened

 private:
  using Segment = std::tuple<wire::BootTag, MacAddress, std::uint8_t, std::uint32_t, std::uint32_t>;
  using Hop = std::pair<MacAddress, MacAddress>;

  void take(Medium::Node node, const Frame& frame) {
    if (frame.destination != Team::address(node)) return;
    if (frame.bytes[1] != static_cast<std::uint8_t>(FrameType::kData)) return;
    const auto body = wire::open_body(frame.bytes);
    const auto data = body ? wire::read_data(*body) : std::nullopt;
    if (!data) return;
    // The source may send a segment again over another way; each such journey has its own start.
    auto& journeys = passed_[{data->source_boot, data->destination, data->stream, data->packet, data->index}];
    if (frame.source == data->source) {
      journeys.push_back({{frame.source, frame.destination}});
      return;
    }
    for (auto journey = journeys.rbegin(); journey != journeys.rend(); ++journey) {
      if (journey->back().second != frame.source) continue;
      check(*journey, frame);
      journey->push_back({frame.source, frame.destination});
      return;
    }
  }

  void check(const std::vector<Hop>& journey, const Frame& frame) {
    const bool been_there = std::any_of(journey.begin(), journey.end(), [&](const Hop& hop) {
      return hop.first == frame.destination || hop.second == frame.destination;
    });
    if (been_there)
      returns.push_back("to robot_" + std::to_string(frame.destination[5]) + " at " +
                        std::to_string(team_.now() / 1ms) + " ms");
  }

  Team& team_;
  std::map<Segment, std::vector<std::vector<Hop>>> passed_;
};

TEST(Restart, A11_4_A13_1_DataNeverPassesARobotTwiceWhileRobotsOfARingRestart) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    MediumOptions medium;
    medium.loss = seed % 2 == 0 ? 0.05 : 0.0;
    Team team(medium, seed);
    add_ring(team);
    Trail trail(team);
    Random random(seed);
    team.run_for(2s);
    for (int step = 0; step < 200; ++step) {
      const std::size_t from = random.next() % 4;
      team.send(from, Team::name((from + 2) % 4), noise(100));
      team.send(from, Team::name((from + 1) % 4), noise(100));
      if (step % 15 == 14) team.restart(random.next() % 4);
      team.run_for(20ms + random.delay(100ms));
    }
    EXPECT_GT(trail.segments(), 200u) << "seed " << seed;
    EXPECT_TRUE(trail.returns.empty()) << trail.returns.size() << " times, first " << trail.returns[0] << ", seed "
                                       << seed;
  }
}

}  // namespace
}  // namespace adhoc_communication
