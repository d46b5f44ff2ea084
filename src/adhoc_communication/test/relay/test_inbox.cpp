// What is published of packets of other robots, what waits, and what is told.
#include <gtest/gtest.h>

#include <algorithm>

#include "adhoc_communication/compression.hpp"
#include "fake_topics.hpp"
#include "relay/definition_md5.hpp"
#include "relay/group_news.hpp"
#include "relay/inbox.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

const std::string kTypeName = "pkg/Type";
const std::string kDefinition = "float64 x\n";
std::string sum() { return md5_of_definition(kTypeName, kDefinition); }

PacketReceived packet(PayloadType payload_type, const std::string& topic, const std::string& octets,
                      const std::string& source = "bob") {
  const SerializedMessage message{kTypeName, sum(), kDefinition, Bytes(octets.begin(), octets.end()), false};
  const bool with_definition = payload_type == PayloadType::kAnyMessage || payload_type == PayloadType::kDefinition;
  PacketReceived result;
  result.source = source;
  result.topic = topic;
  result.payload_type = static_cast<std::uint8_t>(payload_type);
  result.payload = with_definition ? encode_any_message(message) : encode_message_by_type(message);
  return result;
}
PacketReceived any(const std::string& topic, const std::string& octets) {
  return packet(PayloadType::kAnyMessage, topic, octets);
}
PacketReceived by_type(const std::string& topic, const std::string& octets, const std::string& source = "bob") {
  return packet(PayloadType::kMessageByType, topic, octets, source);
}
PacketReceived of_another_type(const std::string& topic, const std::string& octets, const std::string& source) {
  PacketReceived result = packet(PayloadType::kAnyMessage, topic, octets, source);
  const SerializedMessage other{
      "pkg/Other", md5_of_definition("pkg/Other", ""), "", {octets.begin(), octets.end()}, false};
  result.payload = encode_any_message(other);
  return result;
}
PacketReceived definition() { return packet(PayloadType::kDefinition, "definition", ""); }

class InboxTest : public testing::Test {
 protected:
  using Texts = std::vector<std::string>;

  FakeTopics local;
  Texts told;
  Texts asked;
  Texts answered;
  Texts joined;
  Inbox inbox{local,
              TopicFilter("* /odom", "*/denied"),
              {decode_any_message,
               [this](const std::string& robot, const TypeName& type) { asked.push_back(robot + " " + type.type); },
               [this](const PacketReceived& request) { answered.push_back(request.source); },
               [this](const PacketReceived& word) { joined.push_back(GroupNews::member_in(word)); },
               [this](const std::string& text) { told.push_back(text); }}};
};

TEST_F(InboxTest, PublishesUnderOneNameAndLatchesAsTheSender) {
  PacketReceived passing = any("//scan/", "1");
  passing.latched = false;
  inbox.take(passing, 0s);
  inbox.take(any("map", "2"), 0s);
  EXPECT_EQ(local.published, (Texts{"/scan 1", "/map 2"}));
  EXPECT_EQ(local.advertised, (std::map<std::string, bool>{{"/scan", false}, {"/map", true}}));
  EXPECT_TRUE(told.empty());
}

TEST_F(InboxTest, WhatSlowSubscribersLoseIsCountedAndToldOncePerTopic) {
  inbox.take(any("map", "1"), 0s);
  for (int i = 0; i < 3; ++i) {
    local.dropped["/map"] = 2;
    inbox.release(i * 1ms);
  }
  EXPECT_EQ(inbox.take_dropped(), 6u);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("'/map'"), std::string::npos) << told[0];
}

TEST_F(InboxTest, WhoComesLateDoesNotDriveOnAnOldCommand) {
  PacketReceived command;
  command.topic = "drive";
  command.payload_type = static_cast<std::uint8_t>(PayloadType::kAnyMessage);
  const std::string fields = "float64 x\n";
  command.payload =
      encode_any_message({"geometry_msgs/Twist", md5_of_definition("geometry_msgs/Twist", fields), fields, {1}, false});
  inbox.take(command, 0s);
  EXPECT_EQ(local.advertised, (std::map<std::string, bool>{{"/drive", false}}));
}

TEST_F(InboxTest, AMessageWaitsForItsDefinitionAndIsAskedForOnce) {
  inbox.take(by_type("scan", "1"), 0s);
  inbox.take(by_type("scan", "2"), 100ms);
  EXPECT_EQ(asked, Texts{"bob pkg/Type"});
  EXPECT_TRUE(local.published.empty());
  inbox.take(definition(), 200ms);
  inbox.take(by_type("scan", "3"), 300ms);
  EXPECT_EQ(local.published, (Texts{"/scan 1", "/scan 2", "/scan 3"}));
  EXPECT_EQ(inbox.take_dropped(), 0u);
}

/// A newcomer to a group that got one message, whose question was lost, never showed it.
TEST_F(InboxTest, ADefinitionThatDoesNotComeIsAskedForAgainThoughNoMessageFollows) {
  inbox.take(by_type("scan", "1"), 0s);
  EXPECT_TRUE(inbox.anything_waits()) << "so that release() is called";
  inbox.release(500ms);
  EXPECT_EQ(asked.size(), 1u);
  inbox.release(1s);
  EXPECT_EQ(asked, (Texts{"bob pkg/Type", "bob pkg/Type"}));
  inbox.take(definition(), 1100ms);
  EXPECT_EQ(local.published, Texts{"/scan 1"});
}

TEST_F(InboxTest, AnUnaskedDefinitionIsNotKept) {
  inbox.take(definition(), 0s);
  inbox.take(by_type("scan", "1"), 0s);
  EXPECT_EQ(asked.size(), 1u);
}

TEST_F(InboxTest, ADefinitionHasToHaveItsSum) {
  inbox.take(by_type("scan", "1"), 0s);
  PacketReceived forged = definition();
  forged.payload = encode_any_message({kTypeName, sum(), "float64 y\n", {}, false});
  inbox.take(forged, 0s);
  EXPECT_TRUE(local.published.empty());
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("does not have the MD5 sum"), std::string::npos) << told[0];
}

TEST_F(InboxTest, QuestionsAreHandedOn) {
  inbox.take(packet(PayloadType::kDefinitionRequest, "definition", ""), 0s);
  EXPECT_EQ(answered, Texts{"bob"});
}

TEST_F(InboxTest, WordOfANewMemberIsHandedOn) {
  PacketReceived word;
  word.source = "alice";
  word.topic = "new_member";
  word.payload_type = static_cast<std::uint8_t>(PayloadType::kNewMember);
  word.payload = {'c', 'a', 'r', 'o', 'l'};
  inbox.take(word, 0s);
  EXPECT_EQ(joined, Texts{"carol"});
  word.payload = {'\n'};
  inbox.take(word, 0s);
  EXPECT_EQ(joined.size(), 1u);
  EXPECT_EQ(inbox.take_dropped(), 1u);
}

TEST_F(InboxTest, WhatIsRefusedIsCountedAndToldOncePerTopic) {
  for (int i = 0; i < 3; ++i) inbox.take(any("/denied", "x"), 0s);
  inbox.take(any("not a topic", "x"), 0s);
  EXPECT_EQ(inbox.take_dropped(), 4u);
  EXPECT_EQ(inbox.take_dropped(), 0u);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_NE(told[0].find("other robots may not publish '/denied' here"), std::string::npos) << told[0];
  EXPECT_NE(told[1].find("is not a valid topic name"), std::string::npos) << told[1];
}

TEST_F(InboxTest, WhatOwnNodesPublishIsRefusedUnlessNamed) {
  local.published_by_others = {"/scan", "/odom"};
  inbox.take(any("scan", "1"), 0s);
  inbox.take(any("odom", "2"), 0s);
  EXPECT_EQ(local.published, Texts{"/odom 2"});
}

TEST_F(InboxTest, ATopicThatAnOwnNodePublishesLaterIsGivenUp) {
  inbox.take(any("scan", "1"), 0s);
  local.published_by_others = {"/scan"};
  for (int i = 0; i < 9; ++i) inbox.take(any("scan", "2"), i * 100ms);
  EXPECT_EQ(local.published.size(), 10u);
  inbox.take(any("scan", "3"), 1s);
  EXPECT_EQ(local.published.size(), 10u);
  EXPECT_TRUE(local.advertised.empty());
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("nodes of this robot publish '/scan'"), std::string::npos) << told[0];
  local.published_by_others->clear();
  inbox.take(any("scan", "4"), 2s);
  EXPECT_EQ(local.published.back(), "/scan 4");
}

TEST_F(InboxTest, WhatIsCarriedOrRefusedIsAskedForOnceASecond) {
  local.published_by_others = {"/scan"};
  for (int i = 0; i < 100; ++i) {
    inbox.take(any("scan", "1"), i * 10ms);
    inbox.take(any("map", "2"), i * 10ms);
  }
  EXPECT_EQ(local.times_asked, 1) << "of both topics as they were new";
}

TEST_F(InboxTest, WhileTheMasterIsSilentKnownTopicsGoOn) {
  inbox.take(any("map", "1"), 0s);
  local.published_by_others.reset();
  for (int i = 0; i < 29; ++i) {
    inbox.take(any("map", "2"), 1s + i * 100ms);
    inbox.take(any("scan", "3"), 1s + i * 100ms);
  }
  EXPECT_EQ(local.times_asked, 2);
  EXPECT_EQ(local.published.size(), 30u);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("the ROS master does not answer"), std::string::npos) << told[0];
  local.published_by_others.emplace();
  inbox.take(any("scan", "4"), 4s);
  EXPECT_EQ(local.published.back(), "/scan 4");
}

/// The publishing thread asked by itself, two times of each new topic, and stood still for as long as that took.
TEST_F(InboxTest, NothingButNewTopicsWaitsForTheMaster) {
  inbox.take(any("map", "1"), 0s);
  local.answers = false;
  inbox.take(any("scan", "2"), 10ms);
  inbox.take(any("scan", "3"), 20ms);
  inbox.take(any("pose", "4"), 30ms);
  inbox.take(any("map", "5"), 40ms);
  EXPECT_EQ(local.published, (Texts{"/map 1", "/map 5"}));
  EXPECT_EQ(local.times_asked, 2);
  EXPECT_TRUE(inbox.anything_waits());
  local.answers = true;
  local.published_by_others = {"/pose"};
  local.expected["/scan"] = 1;
  inbox.release(100ms);
  EXPECT_EQ(local.times_asked, 2) << "one answer tells who publishes and who subscribes";
  EXPECT_EQ(local.published.size(), 2u) << "the subscriber is to connect";
  local.connected["/scan"] = 1;
  inbox.release(105ms);
  EXPECT_EQ(local.published, (Texts{"/map 1", "/map 5", "/scan 2", "/scan 3"}));
  EXPECT_FALSE(inbox.anything_waits());
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("nodes of this robot publish '/pose'"), std::string::npos) << told[0];
}

TEST_F(InboxTest, AMasterThatNeverAnswersIsNotWaitedForForEver) {
  inbox.take(any("map", "1"), 0s);
  local.answers = false;
  for (int i = 0; i < 100; ++i) {
    inbox.take(any("scan", "2"), 1s + i * 50ms);
    inbox.take(any("odom", "3"), 1s + i * 50ms);
    inbox.take(any("map", "4"), 1s + i * 50ms);
  }
  EXPECT_EQ(local.times_asked, 2) << "the question is still open";
  EXPECT_EQ(std::count(local.published.begin(), local.published.end(), "/map 4"), 100);
  EXPECT_EQ(std::count(local.published.begin(), local.published.end(), "/odom 3"), 100)
      << "of a topic that is allowed by name";
  EXPECT_EQ(inbox.take_dropped(), 90u) << "10 wait again";
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("the ROS master does not answer"), std::string::npos) << told[0];
  local.answers = true;
  inbox.take(any("scan", "5"), 7s);
  EXPECT_EQ(std::vector<std::string>(local.published.end() - 2, local.published.end()), (Texts{"/scan 2", "/scan 5"}));
}

/// Those that came while the master was asked once more were published before those whose definition had come
/// meanwhile.
TEST_F(InboxTest, MessagesThatWaitForTheirDefinitionAndForTheMasterStayInOrder) {
  inbox.take(by_type("scan", "1"), 0s);
  local.answers = false;
  inbox.take(by_type("scan", "2"), 10ms);
  inbox.take(definition(), 20ms);
  inbox.take(by_type("scan", "3"), 30ms);
  EXPECT_TRUE(local.published.empty());
  local.answers = true;
  inbox.take(by_type("scan", "4"), 40ms);
  EXPECT_EQ(local.published, (Texts{"/scan 1", "/scan 2", "/scan 3", "/scan 4"}));
  EXPECT_EQ(inbox.take_dropped(), 0u);
}

TEST_F(InboxTest, AnAnswerThatComesLateIsNotTakenForANewOne) {
  inbox.take(any("map", "1"), 0s);
  local.answers = false;
  inbox.take(any("map", "2"), 1s);
  EXPECT_TRUE(inbox.anything_waits());
  inbox.release(3s);
  EXPECT_FALSE(inbox.anything_waits());
  EXPECT_EQ(local.times_asked, 2);
  local.answers = true;
  inbox.take(any("scan", "3"), 100s);
  EXPECT_EQ(local.times_asked, 3);
  EXPECT_EQ(local.published.back(), "/scan 3");
}

TEST_F(InboxTest, WhatWaitsForTheMasterIsBounded) {
  local.answers = false;
  for (std::size_t i = 0; i < 2 * PacketQueue::kMostPackets; ++i) inbox.take(any("scan", "1"), 0s);
  EXPECT_EQ(inbox.take_dropped(), PacketQueue::kMostPackets);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("too many packets wait for the ROS master"), std::string::npos) << told[0];
  local.answers = true;
  inbox.release(1ms);
  EXPECT_EQ(local.published.size(), PacketQueue::kMostPackets);
}

TEST_F(InboxTest, ATopicThatCannotBeOfferedIsGivenUp) {
  local.pending = {"/scan"};
  inbox.take(any("scan", "1"), 0s);
  EXPECT_TRUE(inbox.anything_waits());
  local.refused["/scan"] = "topic '/scan' cannot be advertised as pkg/Type";
  inbox.release(5ms);
  EXPECT_FALSE(inbox.anything_waits());
  EXPECT_TRUE(local.advertised.empty());
  EXPECT_EQ(inbox.take_dropped(), 1u);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("cannot be advertised"), std::string::npos) << told[0];
}

TEST_F(InboxTest, ATopicHasOneType) {
  inbox.take(any("scan", "1"), 0s);
  inbox.take(of_another_type("scan", "2", "mallory"), 0s);
  inbox.take(any("scan", "3"), 5s);
  inbox.take(of_another_type("scan", "4", "mallory"), 14s);
  EXPECT_EQ(local.published, (Texts{"/scan 1", "/scan 3"}));
  EXPECT_EQ(inbox.take_dropped(), 2u);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("carries pkg/Type of bob here"), std::string::npos) << told[0];
}

TEST_F(InboxTest, WhoBroughtATopicMayChangeItsType) {
  inbox.take(of_another_type("scan", "1", "bob"), 0s);
  inbox.take(any("scan", "2"), 1ms);
  EXPECT_EQ(local.published, (Texts{"/scan 1", "/scan 2"}));
  EXPECT_EQ(local.advertised.size(), 1u);
}

TEST_F(InboxTest, AMistakenPacketDoesNotFixATypeForEver) {
  inbox.take(of_another_type("scan", "1", "mallory"), 0s);
  inbox.take(any("scan", "2"), 9s);
  inbox.take(any("scan", "3"), 10s);
  EXPECT_EQ(local.published, (Texts{"/scan 1", "/scan 3"}));
}

TEST_F(InboxTest, SubscribersOfANewTopicMissNothing) {
  local.expected["/scan"] = 1;
  inbox.take(any("scan", "1"), 0s);
  EXPECT_TRUE(inbox.anything_waits());
  inbox.take(any("map", "2"), 1ms);
  local.connected["/scan"] = 1;
  inbox.release(10ms);
  EXPECT_EQ(local.published, (Texts{"/map 2", "/scan 1"}));
  EXPECT_FALSE(inbox.anything_waits());
}

TEST_F(InboxTest, ARobotWhoseTopicsKeepTooMuchIsNamedOnce) {
  const std::string large(2'500'000, 'x');
  for (int i = 0; i < 5; ++i) inbox.take(any("bomb_" + std::to_string(i), large), i * 1s);
  EXPECT_EQ(local.advertised.size(), 2u);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("Topic '/bomb_0' of bob is given up"), std::string::npos) << told[0];
  EXPECT_EQ(inbox.take_dropped(), 0u);
}

/// Three hundred octets for a topic that is refused took a tenth of a second.
TEST_F(InboxTest, WhatIsRefusedIsNotUnpacked) {
  SendRequest request{"here", "denied", static_cast<std::uint8_t>(PayloadType::kAnyMessage), Bytes(9'000'000)};
  pack(request);
  PacketReceived bomb = any("denied", "");
  bomb.payload = request.payload;
  bomb.unpacked_size = request.unpacked_size - 1;  // who unpacks it notices
  inbox.take(bomb, 0s);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("inject_deny"), std::string::npos) << told[0];
  bomb.payload_type = static_cast<std::uint8_t>(PayloadType::kDefinition);
  inbox.take(bomb, 0s);
  EXPECT_EQ(inbox.take_dropped(), 1u) << "nobody has asked for a definition";
  for (const PayloadType word : {PayloadType::kDefinitionRequest, PayloadType::kNewMember}) {
    bomb.topic = std::string(1, static_cast<char>(word));
    bomb.payload_type = static_cast<std::uint8_t>(word);
    inbox.take(bomb, 0s);
    EXPECT_NE(told.back().find("too large"), std::string::npos) << told.back();
  }
  EXPECT_TRUE(answered.empty());
  EXPECT_TRUE(joined.empty());
}

/// Definitions that came with messages, unasked, made those of others be forgotten.
TEST_F(InboxTest, DefinitionsThatComeWithMessagesTakeTheirSendersRoom) {
  inbox.take(any("map", "1"), 0s);
  for (std::size_t i = 0; i < 2 * Definitions::kMostDefinitions; ++i) {
    const std::string type = "pkg/Type" + std::to_string(i);
    PacketReceived flood = any("flood", "");
    flood.source = "mallory";
    flood.payload = encode_any_message({type, md5_of_definition(type, kDefinition), kDefinition, {}, false});
    inbox.take(flood, 0s);
  }
  local.published.clear();
  inbox.take(by_type("map", "2"), 0s);
  EXPECT_EQ(local.published, Texts{"/map 2"}) << "what bob's message has brought is known";
  EXPECT_TRUE(asked.empty());
}

TEST_F(InboxTest, WhatDoesNotUnpackAsItSaysIsRefused) {
  SendRequest request{"here", "scan", static_cast<std::uint8_t>(PayloadType::kAnyMessage),
                      any("scan", std::string(1000, 'x')).payload};
  pack(request);
  PacketReceived packed = any("scan", "");
  packed.payload = request.payload;
  packed.unpacked_size = request.unpacked_size - 1;
  inbox.take(packed, 0s);
  EXPECT_EQ(inbox.take_dropped(), 1u);
  packed.unpacked_size = request.unpacked_size;
  inbox.take(packed, 0s);
  EXPECT_EQ(local.published.size(), 1u);
}

}  // namespace
}  // namespace adhoc_communication
