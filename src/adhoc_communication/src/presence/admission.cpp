#include "presence/admission.hpp"

#include <algorithm>

namespace adhoc_communication::presence {

using wire::FrameType;

bool Admission::admits(const security::OpenedFrame& opened, Time now) {
  return (guard_.proven(opened.header) || proves_itself(opened, now)) && lives(opened, now);
}

/// A run is believed to be alive now once a beacon of it names this robot's boot id; until then this robot only says
/// that it hears it.
bool Admission::proves_itself(const security::OpenedFrame& opened, Time now) {
  const wire::FrameHeader& header = opened.header;
  const auto beacon = header.type == FrameType::kBeacon ? wire::read_beacon(opened.body) : std::nullopt;
  const bool echo = beacon && std::any_of(beacon->heard.begin(), beacon->heard.end(), [&](const auto& heard) {
                      return heard.tag == wire::neighbor_tag(self_.boot);
                    });
  if (echo) {
    guard_.prove(header);
    return true;
  }
  ++dropped_.unproven;
  if (!beacon) return false;
  const wire::BootTag boot = wire::boot_tag(header.boot_id);
  runs_.suspected(header.sender, boot, now);
  if (neighbors_.candidate(header.sender, boot, now)) rhythm_.greet(now);
  return false;
}

bool Admission::answers(const security::OpenedFrame& opened) const {
  if (opened.header.type != FrameType::kHopAcknowledgment) return false;
  const auto acknowledgment = wire::read_hop_acknowledgment(opened.body);
  return acknowledgment && acknowledgment->boot == self_.boot;
}

/// The frame is one of the run that lives.
bool Admission::lives(const security::OpenedFrame& opened, Time now) {
  const wire::FrameHeader& header = opened.header;
  const wire::BootTag boot = wire::boot_tag(header.boot_id);
  if (header.type == FrameType::kBeacon && !runs_.lives(header.sender, boot)) {
    if (const auto beacon = wire::read_beacon(opened.body)) runs_.beacon(header.sender, boot, beacon->alive, now);
  }
  if (runs_.heard(header.sender, boot, header.counter, now, answers(opened))) return true;
  ++dropped_.unproven;
  return false;
}

}  // namespace adhoc_communication::presence
