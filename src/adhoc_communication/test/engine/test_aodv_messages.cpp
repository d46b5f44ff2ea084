// Messages and sequence numbers: A1 and A2 of docs/aodv.md.
#include <gtest/gtest.h>

#include "host.hpp"
#include "random.hpp"
#include "routing/route_table.hpp"
#include "routing/sequence_number.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

/// A node with a neighbour on either side.
struct Line : Stage {
  explicit Line(EngineOptions options = {}) : Stage(std::move(options)), a(neighbor(1)), b(neighbor(2)) {
    run_for(50ms);
  }
  Host& a;
  Host& b;
};

TEST(Messages, A1_1_A1_3_ReplyIsInNetworkByteOrder) {
  const wire::RouteReply reply{
      false,     true, 2, 0x0110, {2, 0, 0, 0, 0, 2}, 0x01020304, 0x1112131415161718, "bob", {2, 0, 0, 0, 0, 1},
      0x05060708};
  const Bytes expected = {0x40, 2,    1,    0x10, 2, 0, 0, 0, 0, 2, 1, 2, 3, 4, 0x11, 0x12, 0x13, 0x14,
                          0x15, 0x16, 0x17, 0x18, 2, 0, 0, 0, 0, 1, 5, 6, 7, 8, 3,    'b',  'o',  'b'};
  EXPECT_EQ(wire::to_bytes(reply), expected);
}

TEST(Messages, A1_1_A1_4_ErrorIsInNetworkByteOrder) {
  wire::RouteError error{true, false, {{{2, 0, 0, 0, 0, 1}, 0x01020304}, {{2, 0, 0, 0, 0, 2}, 0x05060708}}};
  const Bytes expected = {0x80, 2, 2, 0, 0, 0, 0, 1, 1, 2, 3, 4, 2, 0, 0, 0, 0, 2, 5, 6, 7, 8};
  EXPECT_EQ(wire::to_bytes(error), expected);
}

TEST(Messages, A1_1_A1_8_BeaconIsInNetworkByteOrder) {
  const wire::Beacon beacon{0x01020304, 0x05060708, 0x090a, "bob", 1, {{0x111213141516, 7}}, {}, 3000};
  const Bytes expected = {1, 2,    3,    4,    5,    6,    7,    8, 9, 10, 3, 'b', 'o', 'b',  0,   1,
                          1, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 7, 0, 1,  4, 0,   0,   0x0b, 0xb8};
  EXPECT_EQ(wire::to_bytes(beacon), expected);
}

TEST(Messages, A1_2_ARequestPassedOnDiffersOnlyWhereItHasTo) {
  Line line;
  wire::RouteRequest request = request_for(kFar, kFarther);
  request.join = request.repair = request.gratuitous = true;
  request.hop_count = 3;
  request.hop_limit = 9;
  request.cost = 48;
  line.say(line.a, request);
  line.run_for(10ms);
  ASSERT_EQ(line.requests().size(), 1u);
  ++request.hop_count;
  --request.hop_limit;
  request.cost += 16;
  EXPECT_EQ(wire::to_bytes(line.requests()[0].message), wire::to_bytes(request));
}

TEST(Messages, A1_3_A6_2_AReplyPassedOnDiffersOnlyWhereItHasTo) {
  Line line;
  line.say(line.a, request_for(kFar, line.a));
  line.run_for(10ms);
  wire::RouteReply reply = reply_about(kFar, line.a);
  reply.hop_count = 2;
  reply.cost = 40;
  line.say(line.b, reply, line.self().address);
  line.run_for(10ms);
  const auto replies = line.sent<wire::RouteReply>();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].to, line.a.address);
  ++reply.hop_count;
  reply.cost += 16;
  EXPECT_EQ(wire::to_bytes(replies[0].message), wire::to_bytes(reply));
}

TEST(Messages, A1_4_ErrorsCountTheirDestinations) {
  for (const std::size_t destinations : {1u, 2u, 29u}) {
    Line line;
    for (std::size_t i = 0; i < destinations; ++i) {
      line.say(line.a, request_for(make_host(200 + i), line.a, static_cast<std::uint32_t>(i)));
      line.say(line.b, reply_about(make_host(200 + i), line.a), line.self().address);
      line.run_for(5ms);
    }
    line.b.beacons = line.b.acknowledges = false;
    line.run_for(3s);
    const auto errors = line.sent<wire::RouteError>();
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_EQ(errors[0].message.destinations.size(), destinations + 1) << "those behind the neighbour, and itself";
    EXPECT_EQ(wire::to_bytes(errors[0].message).size(), 2 + 10 * (destinations + 1));
  }
}

TEST(Messages, A1_4_A1_9_ErrorsWithAWrongCountChangeNothing) {
  Line line;
  line.give_route(line.b, kFar);
  const std::uint64_t before = line.malformed();
  Bytes error = wire::to_bytes(error_about({{kFar, 99}}));
  error[1] = 2;
  line.say_octets(line.b, FrameType::kRouteError, error);
  line.say_octets(line.b, FrameType::kRouteError, {0, 0});
  line.run_for(10ms);
  EXPECT_EQ(line.malformed(), before + 2);
  EXPECT_TRUE(line.route(kFar));
  EXPECT_EQ(line.count(FrameType::kRouteError), 0u);
}

TEST(Messages, A1_5_A9_1_AReplyThatAsksForItIsAcknowledged) {
  Line line;
  wire::RouteReply reply = reply_about(kFar, line.self());
  line.say(line.b, reply, line.self().address);
  line.run_for(5ms);
  EXPECT_EQ(line.count(FrameType::kRouteReplyAcknowledgment), 0u);
  reply.acknowledgment_required = true;
  line.say(line.b, reply, line.self().address);
  line.run_for(5ms);
  ASSERT_EQ(line.count(FrameType::kRouteReplyAcknowledgment), 1u);
  for (const auto& [at, frame] : line.frames()) {
    if (frame.bytes[1] != static_cast<std::uint8_t>(FrameType::kRouteReplyAcknowledgment)) continue;
    EXPECT_EQ(frame.destination, line.b.address);
    EXPECT_EQ(frame.bytes.size(), wire::kHeaderSize + wire::kChecksumSize) << "it has no fields";
  }
}

/// What a line sends and knows after a request, a reply and an error with these reserved bits.
std::vector<Bytes> outcome_with(std::uint8_t request_bits, std::uint8_t reply_bits, std::uint8_t error_bits) {
  Line line;
  const auto say = [&](Host& host, FrameType type, Bytes body, std::uint8_t bits) {
    body[0] |= bits;
    line.say_octets(host, type, body);
    line.run_for(10ms);
  };
  say(line.a, FrameType::kRouteRequest, wire::to_bytes(request_for(kFar, line.a)), request_bits);
  say(line.b, FrameType::kRouteReply, wire::to_bytes(reply_about(kFar, line.a)), reply_bits);
  say(line.b, FrameType::kRouteError, wire::to_bytes(error_about({{kFar, 7}})), error_bits);
  std::vector<Bytes> bodies;
  for (const auto& [at, frame] : line.frames()) {
    if (frame.bytes[1] < 2 || frame.bytes[1] > 4) continue;
    bodies.emplace_back(frame.bytes.begin() + wire::kHeaderSize, frame.bytes.end() - wire::kChecksumSize);
  }
  EXPECT_FALSE(line.route(kFar));
  EXPECT_EQ(line.malformed(), 0u);
  return bodies;
}

TEST(Messages, A1_6_ReservedBitsAreIgnoredAndSentAsZero) {
  const std::vector<Bytes> plain = outcome_with(0, 0, 0);
  ASSERT_GE(plain.size(), 3u);
  EXPECT_EQ(outcome_with(0x03, 0x3f, 0x3f), plain);
  EXPECT_EQ(plain[0][0] & 0x03, 0);
  EXPECT_EQ(plain[1][0] & 0x3f, 0);
  EXPECT_EQ(plain[2][0] & 0x3f, 0);
}

TEST(Messages, A1_7_RequestsWithExtensionsAreProcessedOrDiscardedWhole) {
  const auto passed_on = [](const Bytes& extension) {
    Line line;
    Bytes body = wire::to_bytes(request_for(kFar, kFarther));
    body.insert(body.end(), extension.begin(), extension.end());
    line.say_octets(line.a, FrameType::kRouteRequest, body);
    line.run_for(10ms);
    EXPECT_EQ(line.route(kFarther).has_value(), !line.requests().empty());
    return line.requests().size();
  };
  EXPECT_EQ(passed_on({100, 4, 1, 2, 3, 4}), 1u);
  EXPECT_EQ(passed_on({100, 0, 127, 1, 9}), 1u);
  EXPECT_EQ(passed_on({200, 4, 1, 2, 3, 4}), 0u);
  EXPECT_EQ(passed_on({100, 5, 1, 2, 3, 4}), 0u);
  EXPECT_EQ(passed_on({100}), 0u);
}

/// Whether the route to a neighbour whose beacons promised an interval of 3 s is there so long after the last one.
bool still_there(const Timings& timings, Time silence) {
  EngineOptions options;
  options.timings = timings;
  options.num_link_retrans = 0;  // with it, the node asks a quiet neighbour and knows sooner
  Stage stage(options);
  Host& b = stage.neighbor(2, false);
  b.announced_interval_ms = 3000;
  stage.beacon(b);
  stage.run_for(silence);
  return stage.route(b).has_value() && stage.node().links()[0].two_way;
}

TEST(Messages, A1_8_TheHelloIntervalSetsHowLongTheNextIsAwaited) {
  for (const Timings& timings : {rfc3561_timings(), robot_timings()}) {
    const Time patience = timings.allowed_hello_loss * 3s;
    EXPECT_TRUE(still_there(timings, patience - 10ms));
    EXPECT_FALSE(still_there(timings, patience + 10ms));
  }
}

/// Every kind of message that is not open at its end, cut short anywhere and with an octet too many.
TEST(Messages, A1_9_TruncatedMessagesAndRubbishBehindThemChangeNothing) {
  Line line;
  line.give_route(line.b, kFar);
  const wire::Beacon beacon{9, 9, 9, line.a.name, 1, {{wire::neighbor_tag(line.self().boot()), 0}}, {}, 0};
  const std::vector<std::pair<FrameType, Bytes>> messages = {
      {FrameType::kBeacon, wire::to_bytes(beacon)},
      {FrameType::kRouteRequest, wire::to_bytes(request_for(line.self(), kFarther))},
      {FrameType::kRouteReply, wire::to_bytes(reply_about(kFarther, line.self()))},
      {FrameType::kRouteError, wire::to_bytes(error_about({{kFar, 50}}))},
      {FrameType::kHopAcknowledgment, wire::to_bytes(wire::HopAcknowledgment{line.self().boot(), 1, 2, 3, 4, 5})},
      {FrameType::kData, wire::to_bytes(data_for(line.self(), kFarther))},
  };
  const auto refused = [&](FrameType type, const Bytes& body) {
    const std::uint64_t before = line.malformed();
    line.say_octets(line.b, type, body);
    return line.malformed() == before + 1;
  };
  for (const auto& [type, body] : messages) {
    for (std::size_t size = 0; size < body.size(); ++size) {
      EXPECT_TRUE(refused(type, Bytes(body.begin(), body.begin() + static_cast<std::ptrdiff_t>(size)))) << size;
    }
    Bytes longer = body;
    longer.push_back(0);
    EXPECT_TRUE(refused(type, longer)) << static_cast<int>(type);
  }
  EXPECT_TRUE(refused(FrameType::kRouteReplyAcknowledgment, {0}));
  line.run_for(50ms);
  EXPECT_TRUE(line.route(kFar));
  EXPECT_FALSE(line.entry(kFarther));
  EXPECT_EQ(line.count(FrameType::kRouteReply), 0u);
  EXPECT_TRUE(line.team.received(0).empty());
}

TEST(Messages, A1_9_B1_8_UnknownTypesChangeNothing) {
  Line line;
  for (int type = 0; type < 256; ++type) {
    if (type >= 1 && type <= 14) continue;
    for (std::size_t size = 0; size <= 64; size += 8) {
      const std::uint64_t before = line.malformed();
      line.say_octets(line.a, static_cast<FrameType>(type), noise(size));
      EXPECT_EQ(line.malformed(), before + 1) << type;
    }
  }
  EXPECT_EQ(line.node().routes().size(), 2u);
}

/// Raises the node's own number by asking for it.
void preset_own_number(Line& line, std::uint32_t number) {
  static std::uint32_t id = 1000;
  // What is asked may be ahead by less than half of the range.
  for (const std::uint32_t step : {number / 3, number / 3 * 2, number}) {
    wire::RouteRequest request = request_for(line.self(), line.a, ++id);
    request.unknown_sequence_number = false;
    request.destination_sequence = step;
    ++line.a.sequence;
    line.say(line.a, request);
    line.run_for(5ms);
  }
  line.forget();
}

TEST(SequenceNumber, A2_1_OwnNumberWrapsToZero) {
  Line line;
  preset_own_number(line, 0xffffffff);
  line.team.send(0, "nobody", text("x"));
  line.run_for(200ms);
  ASSERT_EQ(line.requests().size(), 2u);
  EXPECT_EQ(line.requests()[0].message.originator_sequence, 0u);
  EXPECT_EQ(line.requests()[1].message.originator_sequence, 1u);
}

TEST(SequenceNumber, A2_2_OfTwoTheOneAheadByLessThanHalfTheRangeIsNewer) {
  const std::vector<std::pair<std::uint32_t, bool>> ahead = {
      {0, false}, {1, true}, {0x7fffffff, true}, {0x80000000, false}, {0x80000001, false}, {0xffffffff, false}};
  for (const std::uint32_t from : {0u, 5u, 0x7fffffffu, 0x80000000u, 0xfffffff0u}) {
    for (const auto& [distance, newer] : ahead) EXPECT_EQ(routing::is_newer(from + distance, from), newer) << distance;
  }
}

/// The node stores one number and is told another by the same neighbour. What does it store then?
std::uint32_t stored_after(std::uint32_t first, std::uint32_t second) {
  Line line;
  Host destination = kFar;
  destination.sequence = first;
  line.give_route(line.b, destination);
  destination.sequence = second;
  line.give_route(line.b, destination);
  return line.route(kFar)->sequence;
}

TEST(SequenceNumber, A2_2_WrappedNumbersAreNewerOnTheAir) {
  EXPECT_EQ(stored_after(0xfffffff0, 0x10), 0x10u);
  EXPECT_EQ(stored_after(0x10, 0xfffffff0), 0x10u);
}

TEST(SequenceNumber, A2_3_OwnNumberGrowsBeforeEachDiscovery) {
  Line line;
  line.team.send(0, "nobody", text("x"));
  line.run_for(3s);
  line.team.send(0, "nobody_else", text("x"));
  line.run_for(3s);
  const auto requests = line.requests();
  ASSERT_EQ(requests.size(), 8u);
  for (std::size_t i = 1; i < requests.size(); ++i) {
    EXPECT_EQ(requests[i].message.originator_sequence, requests[i - 1].message.originator_sequence + 1);
  }
}

/// The number that the node, whose own one is this, answers with.
std::uint32_t answered(std::uint32_t own, std::uint32_t asked, bool unknown = false, bool destination_only = false) {
  Line line;
  preset_own_number(line, own);
  wire::RouteRequest request = request_for(line.self(), kFarther);
  request.unknown_sequence_number = unknown;
  request.destination_sequence = asked;
  request.destination_only = destination_only;
  line.say(line.a, request);
  line.run_for(5ms);
  EXPECT_EQ(line.sent<wire::RouteReply>().size(), 1u);
  return line.sent<wire::RouteReply>().at(0).message.destination_sequence;
}

TEST(SequenceNumber, A2_4_A11_3_AnAnswerCarriesAtLeastTheNumberAskedFor) {
  EXPECT_EQ(answered(7, 3), 7u);
  EXPECT_EQ(answered(7, 7), 7u);
  EXPECT_EQ(answered(7, 8), 8u);
  EXPECT_EQ(answered(7, 20), 20u);
  EXPECT_EQ(answered(7, 20, true), 7u);
  EXPECT_EQ(answered(0xffffffff, 0), 0u);
  EXPECT_EQ(answered(7, 3, false, true), 8u) << "only the destination was asked: with a new number";
}

TEST(SequenceNumber, A2_5_StoredNumbersNeverGoBack) {
  using namespace routing;
  const Timings timings = robot_timings();
  RouteTable table(timings);
  Random random(5);
  std::uint32_t newest = 0xfffff000;
  std::optional<std::uint32_t> stored;
  const auto neighbor = [&] { return make_host(1 + random.next() % 3).address; };
  for (int step = 0; step < 200'000; ++step) {
    const Time now = Time(step) * 1'000'000;
    const std::uint32_t number = newest - 8 + static_cast<std::uint32_t>(random.next() % 10);
    if (is_newer(number, newest)) newest = number;
    switch (random.next() % 5) {
      case 0:
      case 1: {
        const auto hops = static_cast<std::uint8_t>(1 + random.next() % 5);
        table.update({kFar.address, 5, number, hops, static_cast<Cost>(16 * hops), neighbor(), now + 40ms});
        break;
      }
      case 2:
        table.break_link(neighbor(), now);
        break;
      case 3:
        table.break_destinations(error_about({{kFar, number}}), neighbor(), now);
        break;
      default:
        table.expire(now);
    }
    const Route* route = table.find(kFar.address);
    if (route == nullptr) continue;
    if (stored) ASSERT_FALSE(is_newer(*stored, route->sequence)) << step;
    stored = route->sequence;
    if (is_newer(*stored, newest)) newest = *stored;
  }
}

TEST(SequenceNumber, A2_6_A2_7_ALostRouteIsRevivedByTheRaisedNumberAndNoOlder) {
  Line line;
  line.say(line.a, request_for(kFar, line.a));
  Host far = kFar;
  far.sequence = 40;
  line.say(line.b, reply_about(far, line.a), line.self().address);
  line.run_for(10ms);
  line.b.beacons = line.b.acknowledges = false;
  line.run_for(3s);
  const auto errors = line.sent<wire::RouteError>();
  ASSERT_EQ(errors.size(), 1u);
  std::map<MacAddress, std::uint32_t> lost;
  for (const auto& destination : errors[0].message.destinations) lost[destination.address] = destination.sequence;
  EXPECT_EQ(lost, (std::map<MacAddress, std::uint32_t>{{kFar.address, 41}, {line.b.address, line.b.sequence + 1}}));
  EXPECT_EQ(line.entry(kFar)->sequence, 41u);

  line.give_route(line.a, far);
  EXPECT_FALSE(line.route(kFar));
  far.sequence = 41;
  line.give_route(line.a, far);
  EXPECT_TRUE(line.route(kFar));
}

TEST(SequenceNumber, A2_8_A5_1_ATransmitterIsEnteredWithoutNumber) {
  Stage stage;
  Host& b = stage.neighbor(2, false);
  stage.acknowledge(b);  // it hears the node, and has told no number yet
  stage.say(b, request_for(kFar, kFarther));
  ASSERT_TRUE(stage.route(b));
  EXPECT_FALSE(stage.route(b)->sequence_valid);
  ASSERT_TRUE(stage.route(kFarther));
  EXPECT_TRUE(stage.route(kFarther)->sequence_valid);
}

}  // namespace
}  // namespace adhoc_communication
