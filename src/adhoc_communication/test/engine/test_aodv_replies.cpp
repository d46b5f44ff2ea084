// Answers, and passing them on: A6 of docs/aodv.md; one-way links: A9.
#include <gtest/gtest.h>

#include "host.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

bool has(const std::vector<MacAddress>& addresses, const Host& host) {
  return std::find(addresses.begin(), addresses.end(), host.address) != addresses.end();
}

/// A node with a neighbour on either side.
struct ReplyLine : Stage {
  explicit ReplyLine(EngineOptions options = {}) : Stage(std::move(options)), a(neighbor(1)), b(neighbor(2)) {
    run_for(50ms);
  }
  /// a asks for the host, b answers, the node passes on both.
  void open_way(const Host& destination, const Host& originator, std::uint8_t hops = 0) {
    say(a, request_for(destination, originator, ++id));
    wire::RouteReply reply = reply_about(destination, originator);
    reply.hop_count = hops;
    say(b, reply, self().address);
    run_for(5ms);
  }
  void lose(Host& host) {
    host.beacons = host.acknowledges = false;
    run_for(3s);
  }
  Host& a;
  Host& b;
  std::uint32_t id = 0;
};

enum class Stored { kNothing, kValid, kInvalid };

/// Whether the node answers a request for `asked` (nothing: any number will do) from its table.
bool answers(Stored stored, std::optional<std::uint32_t> asked, bool destination_only) {
  ReplyLine line;
  Host far = kFar;
  far.sequence = 10;
  if (stored != Stored::kNothing) line.give_route(line.b, far);
  if (stored == Stored::kInvalid) line.say(line.b, error_about({{far, 10}}));
  line.run_for(50ms);
  line.forget();
  wire::RouteRequest request = request_for(far, line.a);
  request.unknown_sequence_number = !asked;
  request.destination_sequence = asked.value_or(0);
  request.destination_only = destination_only;
  line.say(line.a, request);
  line.run_for(5ms);
  const std::size_t replies = line.sent<wire::RouteReply>().size();
  EXPECT_EQ(replies + line.requests().size(), 1u) << "answers or passes on";
  return replies == 1;
}

TEST(Replies, A6_1_WhoMayAnswer) {
  for (const bool destination_only : {false, true}) {
    const bool may = !destination_only;
    EXPECT_EQ(answers(Stored::kValid, 9, destination_only), may);
    EXPECT_EQ(answers(Stored::kValid, 10, destination_only), may);
    EXPECT_EQ(answers(Stored::kValid, 0xfffffff0, destination_only), may) << "wrapped, so older";
    EXPECT_EQ(answers(Stored::kValid, std::nullopt, destination_only), may);
    EXPECT_FALSE(answers(Stored::kValid, 11, destination_only));
    for (const auto& asked : {std::optional<std::uint32_t>(9), std::optional<std::uint32_t>()}) {
      EXPECT_FALSE(answers(Stored::kInvalid, asked, destination_only));
      EXPECT_FALSE(answers(Stored::kNothing, asked, destination_only));
    }
  }
}

TEST(Replies, A6_1_A2_8_ARouteWithoutNumberAnswersNobody) {
  ReplyLine line;
  Host& c = line.neighbor(3, false);
  line.acknowledge(c);
  line.say(c, error_about({{kFarther, 1}}));
  line.say(c, request_for(kFarther, kFar));
  ASSERT_TRUE(line.route(c));
  ASSERT_FALSE(line.route(c)->sequence_valid);
  line.run_for(5ms);
  line.forget();
  line.say(line.a, request_for(c, line.a));
  line.run_for(5ms);
  EXPECT_TRUE(line.sent<wire::RouteReply>().empty());
  EXPECT_EQ(line.requests().size(), 1u);
}

TEST(Replies, A6_2_A6_3_TheDestinationAnswersWithItsOwnNumber) {
  for (const Timings& timings : {rfc3561_timings(), robot_timings()}) {
    EngineOptions options;
    options.timings = timings;
    ReplyLine line(options);
    wire::RouteRequest request = request_for(line.self(), kFarther);
    request.unknown_sequence_number = false;
    request.destination_sequence = 7;
    request.hop_count = 3;
    line.say(line.a, request);
    line.run_for(5ms);
    const auto replies = line.sent<wire::RouteReply>();
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].to, line.a.address);
    wire::RouteReply expected = reply_about(line.self(), kFarther);
    expected.destination_sequence = 7;
    expected.lifetime_ms = 20'000;
    EXPECT_EQ(wire::to_bytes(replies[0].message), wire::to_bytes(expected));
  }
}

TEST(Replies, A6_4_AnAnswerFromTheTableTellsWhatIsLeftOfTheRoute) {
  ReplyLine line;
  Host far = kFar;
  far.sequence = 10;
  line.give_route(line.b, far, 4, 2s);
  line.run_for(1s);
  line.say(line.a, request_for(far, line.a));
  line.run_for(5ms);
  const auto replies = line.sent<wire::RouteReply>();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].to, line.a.address);
  EXPECT_EQ(replies[0].message.hop_count, 4);
  EXPECT_EQ(replies[0].message.cost, 64);
  EXPECT_EQ(replies[0].message.destination_sequence, 10u);
  EXPECT_EQ(replies[0].message.destination_boot, far.boot());
  EXPECT_EQ(replies[0].message.lifetime_ms, 1000u);
}

TEST(Replies, A6_5_BothSidesOfAnAnswerFromTheTableBecomePrecursors) {
  for (const bool forward : {true, false}) {
    ReplyLine line;
    line.give_route(line.b, kFar);
    line.say(line.a, request_for(kFar, kFarther));
    line.run_for(5ms);
    EXPECT_TRUE(has(line.entry(kFar)->precursors, line.a));
    EXPECT_TRUE(has(line.entry(kFarther)->precursors, line.b));
    line.lose(forward ? line.b : line.a);
    const auto errors = line.sent<wire::RouteError>();
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_EQ(errors[0].to, (forward ? line.a : line.b).address);
    EXPECT_EQ(errors[0].message.destinations[0].address, (forward ? kFar : kFarther).address);
  }
}

TEST(Replies, A6_6_TheDestinationLearnsTheWayBackWhereThatIsAskedFor) {
  for (const bool gratuitous : {true, false}) {
    ReplyLine line;
    line.give_route(line.b, kFar, 2);
    Host originator = kFarther;
    originator.sequence = 30;
    wire::RouteRequest request = request_for(kFar, originator);
    request.gratuitous = gratuitous;
    request.hop_count = 2;
    request.cost = 32;
    line.say(line.a, request);
    line.run_for(5ms);
    const auto replies = line.sent<wire::RouteReply>();
    ASSERT_EQ(replies.size(), gratuitous ? 2u : 1u);
    EXPECT_EQ(replies[0].to, line.a.address);
    if (!gratuitous) continue;
    EXPECT_EQ(replies[1].to, line.b.address);
    const wire::RouteReply& back = replies[1].message;
    EXPECT_EQ(back.destination, originator.address);
    EXPECT_EQ(back.destination_sequence, 30u);
    EXPECT_EQ(back.originator, kFar.address);
    EXPECT_EQ(back.hop_count, 3);
    EXPECT_EQ(back.cost, 48);
    const Time left = line.route(originator)->expires - line.now();
    EXPECT_NEAR(back.lifetime_ms, static_cast<double>(left / 1ms), 6);
  }
}

enum class Known { kNothing, kWithoutNumber, kValid, kInvalid };

/// Whether a reply by way of b takes the place of what is known of the way by a: number 10, three hops.
bool reply_counts(Known known, std::uint32_t number, int hops) {
  ReplyLine line;
  Host far = kFar;
  far.sequence = known == Known::kInvalid ? 9 : 10;  // raised by the loss
  if (known != Known::kNothing) line.give_route(line.a, far, 3);
  if (known == Known::kInvalid) line.say(line.a, error_about({{far, 10}}));
  far.sequence = number;
  line.give_route(line.b, far, hops);
  const auto route = line.route(far);
  const bool taken = route && route->next_hop == line.b.address;
  if (!taken) EXPECT_EQ(line.entry(far)->sequence, 10u);
  return taken;
}

TEST(Replies, A6_7_OnlyNewerOrAsNewAndBetterRepliesCount) {
  for (const int hops : {2, 3, 4}) {
    EXPECT_TRUE(reply_counts(Known::kNothing, 1, hops));
    EXPECT_TRUE(reply_counts(Known::kValid, 11, hops));
    EXPECT_EQ(reply_counts(Known::kValid, 10, hops), hops < 3);
    EXPECT_FALSE(reply_counts(Known::kValid, 9, hops));
    EXPECT_TRUE(reply_counts(Known::kInvalid, 11, hops));
    EXPECT_TRUE(reply_counts(Known::kInvalid, 10, hops));
    EXPECT_FALSE(reply_counts(Known::kInvalid, 9, hops));
  }
}

TEST(Replies, A6_7_A6_8_AReplyMakesARouteAndOneToItsTransmitter) {
  Stage stage;
  Host& b = stage.neighbor(2, false);
  stage.acknowledge(b);
  wire::RouteReply reply = reply_about(kFar, stage.self());
  reply.destination_sequence = 33;
  reply.hop_count = 4;
  reply.lifetime_ms = 1234;
  stage.say(b, reply, stage.self().address);
  const auto route = stage.route(kFar);
  ASSERT_TRUE(route);
  EXPECT_EQ(route->sequence, 33u);
  EXPECT_TRUE(route->sequence_valid);
  EXPECT_EQ(route->next_hop, b.address);
  EXPECT_EQ(route->hops, 5);
  EXPECT_EQ(route->expires, stage.now() + 1234ms);
  ASSERT_TRUE(stage.route(b));
  EXPECT_FALSE(stage.route(b)->sequence_valid);
}

TEST(Replies, A6_9_AReplyIsPassedOnOnceAndOnlyWhereThereIsAWayBack) {
  ReplyLine line;
  line.say(line.b, reply_about(kFar, kFarther), line.self().address);
  line.run_for(5ms);
  EXPECT_TRUE(line.sent<wire::RouteReply>().empty()) << "nobody knows the way to the originator";
  Host far = kFar;
  ++far.sequence;
  wire::RouteRequest request = request_for(far, kFarther);
  request.destination_only = true;
  line.say(line.a, request);
  for (int i = 0; i < 2; ++i) line.say(line.b, reply_about(far, kFarther), line.self().address);
  line.run_for(5ms);
  const auto replies = line.sent<wire::RouteReply>();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].to, line.a.address);
  EXPECT_EQ(replies[0].message.hop_count, 1);
  --far.sequence;
  line.say(line.b, reply_about(far, kFarther), line.self().address);
  line.run_for(5ms);
  EXPECT_EQ(line.sent<wire::RouteReply>().size(), 1u) << "an old one";
}

TEST(Replies, A6_10_PassingOnAReplyNotesWhoReliesOnTheRoute) {
  ReplyLine line;
  line.say(line.a, request_for(kFar, kFarther));
  line.run_for(400ms);
  const Time now = line.now();
  line.say(line.b, reply_about(kFar, kFarther), line.self().address);
  EXPECT_TRUE(has(line.entry(kFar)->precursors, line.a));
  EXPECT_TRUE(has(line.entry(line.b)->precursors, line.a));
  EXPECT_GE(line.entry(kFarther)->expires, now + robot_timings().active_route_timeout);
}

TEST(Replies, A6_11_WaitingDataLeavesWithTheReply) {
  ReplyLine line;
  line.team.send(0, kFar.name, text("x"));
  line.run_for(60ms);
  const Time told = line.now();
  line.say(line.b, reply_about(kFar, line.self()), line.self().address);
  line.run_for(20ms);
  ASSERT_FALSE(line.sent<wire::Data>().empty());
  EXPECT_LT(line.sent<wire::Data>()[0].at - told, 5ms);
}

TEST(Replies, A6_12_AReplyAboutTheNodeItselfMakesNoRoute) {
  ReplyLine line;
  const std::size_t before = line.node().routes().size();
  line.say(line.b, reply_about(line.self(), kFar), line.self().address);
  line.run_for(5ms);
  EXPECT_FALSE(line.entry(line.self()));
  EXPECT_EQ(line.node().routes().size(), before);
  EXPECT_TRUE(line.sent<wire::RouteReply>().empty());
}

EngineOptions without_hop_acknowledgments(const Timings& timings) {
  EngineOptions options;
  options.timings = timings;
  options.num_link_retrans = 0;
  return options;
}

TEST(OneWayLinks, A9_1_WithoutAcknowledgmentsOnHopsRepliesAskForOne) {
  for (const int num_link_retrans : {0, 10}) {
    EngineOptions options;
    options.num_link_retrans = num_link_retrans;
    ReplyLine line(options);
    line.say(line.a, request_for(line.self(), line.a));
    line.run_for(5ms);
    ASSERT_EQ(line.sent<wire::RouteReply>().size(), 1u);
    EXPECT_EQ(line.sent<wire::RouteReply>()[0].message.acknowledgment_required, num_link_retrans == 0);
  }
}

TEST(OneWayLinks, A9_2_AReplyIsRepeatedUntilItIsAcknowledged) {
  ReplyLine line(without_hop_acknowledgments(robot_timings()));
  line.say(line.a, request_for(line.self(), line.a));
  line.run_for(20ms);
  EXPECT_EQ(line.sent<wire::RouteReply>().size(), 2u) << "once more after NEXT_HOP_WAIT";
  line.say_octets(line.a, FrameType::kRouteReplyAcknowledgment, {}, line.self().address);
  line.run_for(1s);
  EXPECT_EQ(line.sent<wire::RouteReply>().size(), 2u);
  EXPECT_TRUE(line.node().links()[0].two_way);
}

/// When the node answers again a neighbour that does not acknowledge replies, after it was blacklisted.
Time ignored_for(const Timings& timings) {
  ReplyLine line(without_hop_acknowledgments(timings));
  std::uint32_t id = 0;
  line.say(line.a, request_for(line.self(), line.a, ++id));
  line.run_for(10ms);
  EXPECT_FALSE(line.sent<wire::RouteReply>().empty());
  while (line.node().links()[0].two_way && line.now() < 1s) line.run_for(1ms);
  const Time blacklisted = line.now();
  line.forget();
  while (line.sent<wire::RouteReply>().empty() && line.now() < 30s) {
    ++line.a.sequence;
    line.say(line.a, request_for(line.self(), line.a, ++id));
    line.run_for(10ms);
  }
  return line.now() - blacklisted;
}

TEST(OneWayLinks, A5_3_A9_2_A9_3_RequestsOfABlacklistedNeighborAreIgnored) {
  EXPECT_NEAR(static_cast<double>(ignored_for(rfc3561_timings()) / 1ms), 5600, 20);
  EXPECT_NEAR(static_cast<double>(ignored_for(robot_timings()) / 1ms), 1050, 20);
}

TEST(OneWayLinks, A9_3_TheWayRoundABlacklistedNeighborIsTaken) {
  ReplyLine line(without_hop_acknowledgments(rfc3561_timings()));
  line.say(line.a, request_for(line.self(), line.a, 1));
  line.run_for(1s);
  line.forget();
  ++line.a.sequence;
  wire::RouteRequest request = request_for(line.self(), line.a, 2);
  line.say(line.a, request);
  request.hop_count = 1;
  request.cost = 16;
  line.say(line.b, request);
  line.run_for(10ms);
  const auto replies = line.sent<wire::RouteReply>();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].to, line.b.address);
}

/// Where hops acknowledge, a lost reply is noticed by the missing acknowledgment.
TEST(OneWayLinks, A9_2_AReplyLostOnTheHopBlacklistsAsWell) {
  ReplyLine line;
  line.a.acknowledges = false;
  line.say(line.a, request_for(line.self(), line.a, 1));
  line.run_for(1200ms);  // frames that go unacknowledged end the link although its beacons go on
  EXPECT_FALSE(line.node().links()[0].two_way);
  EXPECT_FALSE(line.route(line.a));
}

}  // namespace
}  // namespace adhoc_communication
