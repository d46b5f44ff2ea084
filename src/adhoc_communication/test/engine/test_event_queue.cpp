// What happens to events that the host does not take.
#include <gtest/gtest.h>

#include "api/event_queue.hpp"

namespace adhoc_communication {
namespace {

PacketReceived packet(const std::string& source, std::size_t octets) {
  PacketReceived received;
  received.source = source;
  received.payload = Bytes(octets);
  return received;
}

TEST(EventQueue, TheOldestPacketMakesRoomAndEndsOfSendsStay) {
  EventQueue events;
  events.add(SendFinished{1, true, {}, false});
  for (std::size_t i = 0; i < EventQueue::kMostEvents; ++i) events.add(packet(std::to_string(i), 1));
  EXPECT_EQ(events.size(), EventQueue::kMostEvents);
  EXPECT_TRUE(std::holds_alternative<SendFinished>(*events.next()));
  EXPECT_EQ(std::get<PacketReceived>(*events.next()).source, "1");
}

TEST(EventQueue, OctetsAreBoundedButForOnePacket) {
  EventQueue events;
  events.add(packet("a", EventQueue::kMostOctets));
  events.add(packet("b", EventQueue::kMostOctets + 1));
  EXPECT_EQ(events.size(), 1u);
  EXPECT_EQ(events.octets(), EventQueue::kMostOctets + 1);
  EXPECT_EQ(std::get<PacketReceived>(*events.next()).source, "b");
  EXPECT_EQ(events.octets(), 0u);
  EXPECT_FALSE(events.next());
}

TEST(EventQueue, TheEndOfASendMakesNoRoomForItself) {
  EventQueue events;
  events.add(packet("a", EventQueue::kMostOctets + 1));
  events.add(SendFinished{1, true, {}, false});
  EXPECT_EQ(std::get<PacketReceived>(*events.next()).source, "a");
}

}  // namespace
}  // namespace adhoc_communication
