#include "air/transmitter.hpp"

namespace adhoc_communication::air {

using wire::FrameType;

namespace {

/// Frames of which the hop ARQ keeps the order stay in one queue of the radio: one that overtakes others would make
/// them look lost.
bool is_control(FrameType type, std::uint8_t flags) {
  const bool is_data = type == FrameType::kData || type == FrameType::kTransportAcknowledgment ||
                       type == FrameType::kBroadcastData || type == FrameType::kFlood || type == FrameType::kGroupData;
  return !is_data && (flags & wire::kWantsAcknowledgment) == 0;
}

}  // namespace

void Transmitter::transmit(FrameType type, const MacAddress& next_hop, const Labels& labels, const Bytes& body,
                           Time now) {
  const wire::FrameHeader header{type,           labels.flags, self_.address,       self_.boot_id,
                                 labels.counter, next_hop,     labels.link_sequence};
  Frame frame{next_hop, self_.address, guard_.close(header, body), is_control(type, labels.flags)};
  if (type != FrameType::kBeacon && type != FrameType::kHopAcknowledgment) rhythm_.happened(now);
  ++statistics_.frames_sent;
  ++statistics_.frames_sent_by_type[static_cast<std::size_t>(type)];
  const std::size_t octets = frame.bytes.size() + wire::kEthernetHeaderSize;
  statistics_.bytes_sent += octets;
  statistics_.bytes_sent_by_type[static_cast<std::size_t>(type)] += octets;
  air_.transmitted(labels.counter, frame.bytes.size(), next_hop, now);
  frames_.push_back(std::move(frame));
}

}  // namespace adhoc_communication::air
