#include "air/transmitter.hpp"

namespace adhoc_communication::air {

using wire::FrameType;

namespace {

/// Frames of one priority are in one queue of the radio, so that those of a stream stay in order. The few others that
/// one may overtake there arrive before the hop acknowledges without them.
AccessCategory category_of(FrameType type, std::uint8_t priority) {
  if (type == FrameType::kFlood || priority > static_cast<std::uint8_t>(Priority::kPosition)) {
    return AccessCategory::kBestEffort;
  }
  return priority == static_cast<std::uint8_t>(Priority::kControl) ? AccessCategory::kVoice : AccessCategory::kVideo;
}

}  // namespace

void Transmitter::transmit(FrameType type, const MacAddress& next_hop, const Labels& labels, const Bytes& body,
                           Time now) {
  const wire::FrameHeader header{type,           labels.flags, self_.address,       self_.boot_id,
                                 labels.counter, next_hop,     labels.link_sequence};
  Frame frame{next_hop, self_.address, guard_.close(header, body), category_of(type, labels.priority)};
  if (type != FrameType::kBeacon && type != FrameType::kHopAcknowledgment) rhythm_.happened(now);
  ++statistics_.frames_sent;
  ++statistics_.frames_sent_by_type[static_cast<std::size_t>(type)];
  const std::size_t octets = frame.bytes.size() + wire::kEthernetHeaderSize;
  statistics_.bytes_sent += octets;
  statistics_.bytes_sent_by_type[static_cast<std::size_t>(type)] += octets;
  air_.transmitted(labels.counter, frame.bytes.size(), next_hop, now, frame.category);
  frames_.push_back(std::move(frame));
}

}  // namespace adhoc_communication::air
