// What hosts may write down: counters and records.
#include "engine_implementation.hpp"

namespace adhoc_communication {
namespace {

/// Of the frames that name it, the robot that they come from.
std::optional<MacAddress> source_of(const transport::HopFrame& frame) {
  const wire::Reader body(frame.body.data(), frame.body.size());
  if (frame.type == wire::FrameType::kData) {
    const auto data = wire::read_data(body);
    return data ? std::optional(data->source) : std::nullopt;
  }
  if (frame.type == wire::FrameType::kTransportAcknowledgment) {
    const auto acknowledgment = wire::read_transport_acknowledgment(body);
    return acknowledgment ? std::optional(acknowledgment->source) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Record> Engine::Implementation::take_records() {
  statistics_.records_lost = journal_.lost();
  return journal_.take();
}

void Engine::Implementation::count_data(DataFrames& frames, bool passed_on, bool again) {
  if (again) {
    ++(passed_on ? frames.passed_on_again : frames.sent_again);
  } else {
    ++(passed_on ? frames.passed_on : frames.sent);
  }
}

void Engine::Implementation::record_passed(const MacAddress& neighbor, std::vector<transport::HopSender::Passed> passed,
                                           Time now) {
  for (const auto& [frame, link_sequence, sent, repetitions] : passed) {
    const MacAddress source = source_of(frame).value_or(self_.address);
    journal_.add(now,
                 FramePassed{name_or_address(source), self_.address, neighbor, link_sequence, sent, now, repetitions});
  }
}

void Engine::Implementation::record_segments(const StreamKey& key, Stream& stream, Time now) {
  const std::vector<transport::StreamSender::Ended> all = stream.sender.take_ended();
  if (all.empty()) return;
  const RouteEnds route = router_.ends_to(stream.address.value_or(MacAddress{}), now);
  for (const auto& [packet, index, repetitions, sent, ended, delivered] : all) {
    journal_.add(now, SegmentEnded{packet, index, key.first, repetitions, sent, ended, delivered, route});
  }
}

}  // namespace adhoc_communication
