// Definitions learnt, messages that wait for theirs.
#include <gtest/gtest.h>

#include "relay/definitions.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

const TypeName kType{"pkg/Type", std::string(32, 'a')};
const TypeName kOther{"pkg/Other", std::string(32, 'b')};

PacketReceived packet(const std::string& topic, std::size_t octets = 1, const std::string& source = "alice") {
  PacketReceived result;
  result.source = source;
  result.topic = topic;
  result.payload.resize(octets);
  return result;
}

std::vector<std::string> topics(const std::vector<PacketReceived>& packets) {
  std::vector<std::string> result;
  for (const auto& item : packets) result.push_back(item.topic);
  return result;
}

TEST(Definitions, FirstOneReceivedCounts) {
  Definitions definitions;
  EXPECT_EQ(definitions.find(kType), nullptr);
  definitions.learn(kType, "float64 x", "alice");
  definitions.learn(kType, "something else", "alice");
  ASSERT_NE(definitions.find(kType), nullptr);
  EXPECT_EQ(*definitions.find(kType), "float64 x");
}

TEST(Definitions, MessagesWaitInOrderAndTheirSenderIsAskedOnceASecond) {
  Definitions definitions;
  EXPECT_TRUE(definitions.hold(packet("1"), kType, 0s));
  EXPECT_FALSE(definitions.hold(packet("2"), kType, 999ms));
  EXPECT_TRUE(definitions.hold(packet("other"), kOther, 999ms));
  EXPECT_TRUE(definitions.hold(packet("3"), kType, 1s));
  EXPECT_TRUE(definitions.awaits(kType));
  EXPECT_EQ(topics(definitions.learn(kType, "float64 x", "alice")), (std::vector<std::string>{"1", "2", "3"}));
  EXPECT_FALSE(definitions.awaits(kType));
  EXPECT_TRUE(definitions.awaits(kOther));
  EXPECT_TRUE(definitions.learn(kType, "float64 x", "alice").empty());
}

/// The question, or the answer, may be lost, and the message that waits be the last one.
TEST(Definitions, AreAskedForAgainWhileAMessageWaits) {
  Definitions definitions;
  definitions.hold(packet("1"), kType, 0s);
  EXPECT_TRUE(definitions.take_overdue(999ms).empty());
  const auto overdue = definitions.take_overdue(1s);
  ASSERT_EQ(overdue.size(), 1u);
  EXPECT_EQ(overdue[0].first, "alice");
  EXPECT_EQ(overdue[0].second, kType);
  EXPECT_TRUE(definitions.take_overdue(1999ms).empty());
  EXPECT_EQ(definitions.take_overdue(2s).size(), 1u);
  definitions.learn(kType, "float64 x", "alice");
  EXPECT_TRUE(definitions.take_overdue(4s).empty());
}

TEST(Definitions, PatienceEnds) {
  Definitions definitions;
  definitions.hold(packet("1"), kType, 0s);
  definitions.hold(packet("2"), kType, 1s);
  definitions.expire(Definitions::kPatience);
  EXPECT_EQ(definitions.take_dropped(), 1u);
  EXPECT_EQ(definitions.take_dropped(), 0u);
  definitions.expire(Definitions::kPatience + 1s);
  EXPECT_EQ(definitions.take_dropped(), 1u);
  EXPECT_FALSE(definitions.awaits(kType));
}

TEST(Definitions, HeldMessagesAreBounded) {
  Definitions definitions;
  for (std::size_t i = 0; i < Definitions::kMostHeld + 3; ++i) {
    definitions.hold(packet(std::to_string(i)), kType, 0s);
  }
  EXPECT_EQ(definitions.take_dropped(), 3u);
  const auto released = definitions.learn(kType, "", "alice");
  ASSERT_EQ(released.size(), Definitions::kMostHeld);
  EXPECT_EQ(released.front().topic, "3");
  for (int i = 0; i < 4; ++i) definitions.hold(packet("large", Definitions::kMostHeldOctets / 2), kOther, 0s);
  EXPECT_EQ(definitions.learn(kOther, "", "alice").size(), 2u);
  EXPECT_EQ(definitions.take_dropped(), 2u);
}

TEST(Definitions, KnownOnesAreBounded) {
  Definitions definitions;
  for (std::size_t i = 0; i <= Definitions::kMostDefinitions; ++i) {
    definitions.learn({"pkg/Type" + std::to_string(i), kType.md5sum}, "x", "alice");
  }
  EXPECT_EQ(definitions.find({"pkg/Type0", kType.md5sum}), nullptr);
  EXPECT_NE(definitions.find({"pkg/Type1", kType.md5sum}), nullptr);
  definitions.learn(kOther, std::string(Definitions::kMostOctets, 'x'), "alice");
  EXPECT_NE(definitions.find(kOther), nullptr);
  EXPECT_EQ(definitions.find({"pkg/Type1", kType.md5sum}), nullptr);
  definitions.learn(kType, std::string(Definitions::kMostOctets + 1, 'x'), "alice");
  EXPECT_EQ(definitions.find(kType), nullptr);
}

/// Who brought many made the others' be forgotten.
TEST(Definitions, WhoKeepsMostMakesRoom) {
  Definitions definitions;
  definitions.learn(kType, "float64 x", "bob");
  for (std::size_t i = 0; i < 3 * Definitions::kMostDefinitions; ++i) {
    definitions.learn({"pkg/Type" + std::to_string(i), kType.md5sum}, "x", "alice");
  }
  EXPECT_NE(definitions.find(kType), nullptr);
  for (int i = 0; i < 3; ++i) {
    definitions.learn({"pkg/Large" + std::to_string(i), kType.md5sum}, std::string(Definitions::kMostOctets / 2, 'x'),
                      "alice");
  }
  EXPECT_NE(definitions.find(kType), nullptr);
}

TEST(Definitions, WhoHasMostMessagesWaitingLosesThem) {
  Definitions definitions;
  definitions.hold(packet("of bob", 1, "bob"), kOther, 0s);
  for (std::size_t i = 0; i < 3 * Definitions::kMostHeld; ++i) definitions.hold(packet("of alice"), kType, 0s);
  for (int i = 0; i < 4; ++i) definitions.hold(packet("of alice", Definitions::kMostHeldOctets / 2), kType, 0s);
  EXPECT_EQ(topics(definitions.learn(kOther, "", "alice")), std::vector<std::string>{"of bob"});
}

}  // namespace
}  // namespace adhoc_communication
