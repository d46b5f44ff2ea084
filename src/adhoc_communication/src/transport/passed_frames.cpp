#include "transport/passed_frames.hpp"

#include <optional>

#include "routing/names.hpp"

namespace adhoc_communication::transport {

using wire::FrameType;

namespace {

/// Of the frames that name it, the robot that they come from.
std::optional<MacAddress> source_of(const HopFrame& frame) {
  const wire::Reader body(frame.body.data(), frame.body.size());
  if (frame.type == FrameType::kData) {
    const auto data = wire::read_data(body);
    return data ? std::optional(data->source) : std::nullopt;
  }
  if (frame.type == FrameType::kTransportAcknowledgment) {
    const auto acknowledgment = wire::read_transport_acknowledgment(body);
    return acknowledgment ? std::optional(acknowledgment->source) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

void PassedFrames::add(const MacAddress& neighbor, const std::vector<HopSender::Passed>& passed, Time now) {
  for (const auto& [frame, link_sequence, sent, repetitions] : passed) {
    const MacAddress source = source_of(frame).value_or(self_.address);
    journal_.add(now, FramePassed{routing::name_or_address(self_, directory_, source), self_.address, neighbor,
                                  link_sequence, sent, now, repetitions});
  }
}

}  // namespace adhoc_communication::transport
