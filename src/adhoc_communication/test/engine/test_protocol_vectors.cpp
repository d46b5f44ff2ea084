// docs/protocol_vectors.json is what this engine writes, and it reads all of it.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

#include "protocol_vectors.hpp"
#include "security/cipher.hpp"
#include "security/frame_guard.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

template <typename Message>
Bytes rewritten(const std::optional<Message>& message) {
  return message ? to_bytes(*message) : Bytes{};
}

/// The body as this engine reads and writes it; empty if it does not read it.
Bytes read_and_rewritten(wire::FrameType type, const wire::Reader& body) {
  using wire::FrameType;
  switch (type) {
    case FrameType::kBeacon:
      return rewritten(wire::read_beacon(body));
    case FrameType::kRouteRequest:
      return rewritten(wire::read_route_request(body));
    case FrameType::kRouteReply:
      return rewritten(wire::read_route_reply(body));
    case FrameType::kRouteError:
      return rewritten(wire::read_route_error(body));
    case FrameType::kHopAcknowledgment:
      return rewritten(wire::read_hop_acknowledgment(body));
    case FrameType::kData:
      return rewritten(wire::read_data(body));
    case FrameType::kTransportAcknowledgment:
      return rewritten(wire::read_transport_acknowledgment(body));
    case FrameType::kBroadcastData:
      return rewritten(wire::read_broadcast_data(body));
    case FrameType::kFlood:
      return rewritten(wire::read_flood(body));
    case FrameType::kGroupActivation:
      return rewritten(wire::read_group_activation(body));
    case FrameType::kGroupRefusal:
      return rewritten(wire::read_group_refusal(body));
    case FrameType::kGroupData:
      return rewritten(wire::read_group_data(body));
    case FrameType::kGroupReport:
      return rewritten(wire::read_group_report(body));
    case FrameType::kGroupReceipts:
      return rewritten(wire::read_group_receipts(body));
    case FrameType::kRouteReplyAcknowledgment:
      return {};
  }
  return {};
}

TEST(ProtocolVectors, TheFileIsWhatTheEngineWrites) {
  std::ifstream file(PROTOCOL_VECTORS);
  const std::string stored(std::istreambuf_iterator<char>(file), {});
  const std::string written = protocol_vectors();
  if (stored == written) return;
  const std::string path = testing::TempDir() + "protocol_vectors.json";
  std::ofstream(path) << written;
  FAIL() << PROTOCOL_VECTORS << " differs from what this engine puts on the air. Where that is meant, copy " << path
         << " there and run test/twin/test_protocol_document.py --write";
}

TEST(ProtocolVectors, EveryTypeIsThereAndIsRead) {
  const Identity receiver = vector_receiver();
  FramesDropped dropped;
  security::FrameGuard open_guard(receiver, {}, dropped);
  security::FrameGuard sealed_guard(receiver, {vector_team_key()}, dropped);
  std::set<wire::FrameType> types;
  for (const FrameVector& vector : frame_vectors()) {
    SCOPED_TRACE(vector.name);
    types.insert(vector.header.type);
    wire::FrameHeader sealed = vector.header;
    sealed.flags |= wire::kSealed;
    security::SessionKey key;
    security::derive_session_key(key, vector_team_key(), vector.header.sender, vector.header.boot_id);
    const Frame in_the_open{vector.header.next_hop, vector.header.sender,
                            wire::close_openly(vector.header, vector.body)};
    const Frame under_seal{vector.header.next_hop, vector.header.sender, security::seal(key, sealed, vector.body)};
    const auto opened = open_guard.open(in_the_open, Time(0));
    const auto unsealed = sealed_guard.open(under_seal, Time(0));
    ASSERT_TRUE(opened && unsealed);
    EXPECT_EQ(read_and_rewritten(vector.header.type, opened->body), vector.body);
    EXPECT_EQ(read_and_rewritten(vector.header.type, unsealed->body), vector.body);
  }
  EXPECT_EQ(types.size(), 15u);
}

}  // namespace
}  // namespace adhoc_communication
