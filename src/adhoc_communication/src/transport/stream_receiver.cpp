#include "transport/stream_receiver.hpp"

#include <algorithm>

namespace adhoc_communication::transport {
namespace {

constexpr std::size_t kMostPartialOctets = 240;                  ///< of an acknowledgment, so that it fits any link
constexpr std::size_t kMostBitmapOctets = 128;                   ///< 1024 segments beyond the first missing one
constexpr std::size_t kPartialOctets = 10;                       ///< of a partial packet besides its bitmap
constexpr std::size_t kMostRefused = 3;                          ///< told in one acknowledgment
constexpr Time kLongestSpacing = std::chrono::milliseconds(50);  ///< what is longer is a pause
constexpr int kSpacings = 16;                                    ///< that the mean rests on

bool is_newer_attempt(std::uint8_t attempt, std::uint8_t than) { return static_cast<std::int8_t>(attempt - than) > 0; }

}  // namespace

StreamReceiver::~StreamReceiver() {
  for (std::size_t index = 0; index < streams_.size(); ++index) {
    while (!streams_[index].packets.empty()) drop(index, streams_[index].packets.begin());
  }
}

std::vector<StreamReceiver::Complete> StreamReceiver::take(const wire::Data& data, Time now) {
  std::vector<Complete> complete;
  if (data.total > largest_packet_) return complete;
  Stream& stream = streams_[data.stream];
  if (!stream.started) {
    stream.started = true;
    stream.next = data.base;
  }
  last_used_ = now;
  if (stream.last_segment != Time(0)) {
    stream.spacing += (std::min(now - stream.last_segment, kLongestSpacing) - stream.spacing) / kSpacings;
  }
  stream.last_segment = now;
  if (routing::is_newer(data.base, stream.next)) {
    move_base(data.stream, data.base);
    deliver(data.stream, complete);
  }
  const Stored stored = store(data.stream, data, now);
  deliver(data.stream, complete);
  if (stored == Stored::kFresh) ++stream.unacknowledged;
  // Of a packet refused a whole window may be under way, which need not be answered frame by frame.
  const bool of_use = stored != Stored::kRefused;
  const bool now_due =
      data.acknowledge_now || !of_use || !complete.empty() || stream.unacknowledged >= kSegmentsPerAcknowledgment;
  stream.due = std::min(stream.due, now_due ? now : now + delay(stream));
  return complete;
}

/// Of slow segments, too, many are acknowledged together: each acknowledgment takes the air of all hops, and destroys
/// what a robot sends that does not hear this one. Where segments are missing the source is not kept waiting.
Time StreamReceiver::delay(const Stream& stream) {
  const bool missing = std::any_of(stream.packets.begin(), stream.packets.end(), [](const auto& item) {
    return item.second.assembly.known() > item.second.assembly.first_missing();
  });
  if (missing) return kShortestDelay;
  return std::clamp(2 * kSegmentsPerAcknowledgment * stream.spacing, kShortestDelay, kLongestDelay);
}

StreamReceiver::Stored StreamReceiver::store(std::size_t index, const wire::Data& data, Time now) {
  Stream& stream = streams_[index];
  if (data.packet - stream.next >= kPacketsAhead) return Stored::kRepeated;
  const auto refused = stream.refused.find(data.packet);
  if (refused != stream.refused.end() && refused->second == data.attempt) return Stored::kRefusedBefore;
  Incoming* packet = packet_of(index, data, now);
  if (packet == nullptr) return Stored::kRefused;
  if (is_newer_attempt(data.attempt, packet->attempt)) packet->attempt = data.attempt;
  if (!packet->assembly.take(data.index, data.octets)) return Stored::kRepeated;
  reassembly_.progress(key(index, data.packet), data.octets.size(), now);
  packet->hops = std::max(packet->hops, data.hops);
  return Stored::kFresh;
}

/// The packet that the segment belongs to, admitted now if it is the first one. Null when it is refused.
StreamReceiver::Incoming* StreamReceiver::packet_of(std::size_t index, const wire::Data& data, Time now) {
  Stream& stream = streams_[index];
  const auto found = stream.packets.find(data.packet);
  if (found != stream.packets.end()) {
    if (found->second.assembly.matches(data.total, data.segment_size)) return &found->second;
    // One of the two is forged. The one that goes on arriving is more likely not to be.
    if (reassembly_.stalled(key(index, data.packet), now)) {
      stream.refused[data.packet] = found->second.attempt;
      drop(index, found);
    }
    return nullptr;
  }
  const bool next = data.packet == stream.next;
  if (data.index >= Assembly::kSegmentsAhead) return nullptr;
  if (!reassembly_.admit(key(index, data.packet), data.total, next, now)) {
    stream.refused[data.packet] = data.attempt;
    return nullptr;
  }
  stream.refused.erase(data.packet);
  Incoming packet{Assembly(data.total, data.segment_size), data.attempt, 1};
  return &stream.packets.emplace(data.packet, std::move(packet)).first->second;
}

void StreamReceiver::evicted(std::size_t index, std::uint32_t number, Time now) {
  Stream& stream = streams_[index];
  const auto packet = stream.packets.find(number);
  if (packet == stream.packets.end()) return;
  stream.refused[number] = packet->second.attempt;
  stream.packets.erase(packet);
  stream.due = now;
}

void StreamReceiver::drop(std::size_t index, Packets::iterator packet) {
  reassembly_.release(key(index, packet->first));
  streams_[index].packets.erase(packet);
}

/// The sender has given up what comes before `base`.
void StreamReceiver::move_base(std::size_t index, std::uint32_t base) {
  Stream& stream = streams_[index];
  for (auto iterator = stream.packets.begin(); iterator != stream.packets.end();) {
    const auto packet = iterator++;
    if (routing::is_newer(base, packet->first)) drop(index, packet);
  }
  for (auto iterator = stream.refused.begin(); iterator != stream.refused.end();) {
    iterator = routing::is_newer(base, iterator->first) ? stream.refused.erase(iterator) : std::next(iterator);
  }
  stream.next = base;
}

void StreamReceiver::deliver(std::size_t index, std::vector<Complete>& out) {
  Stream& stream = streams_[index];
  for (auto found = stream.packets.find(stream.next);
       found != stream.packets.end() && found->second.assembly.complete(); found = stream.packets.find(stream.next)) {
    out.push_back({found->second.assembly.take_image(), found->second.hops});
    drop(index, found);
    ++stream.next;
  }
}

Time StreamReceiver::next_deadline() const {
  Time next = Time::max();
  for (const Stream& stream : streams_) next = std::min(next, stream.due);
  return next;
}

wire::TransportAcknowledgment StreamReceiver::acknowledge(std::size_t index) {
  Stream& stream = streams_[index];
  stream.unacknowledged = 0;
  stream.due = Time::max();
  wire::TransportAcknowledgment acknowledgment;
  acknowledgment.stream = static_cast<std::uint8_t>(index);
  acknowledgment.next = stream.next;
  for (const auto& [number, attempt] : stream.refused) {
    if (acknowledgment.refused.size() < kMostRefused) acknowledgment.refused.push_back({number, attempt});
  }
  std::size_t octets = 0;
  for (const auto& [number, packet] : stream.packets) {
    wire::PartialPacket partial = partial_of(number, packet);
    octets += kPartialOctets + partial.received.size();
    if (octets > kMostPartialOctets) break;
    acknowledgment.partial.push_back(std::move(partial));
  }
  return acknowledgment;
}

wire::PartialPacket StreamReceiver::partial_of(std::uint32_t number, const Incoming& packet) {
  const std::uint32_t first = packet.assembly.first_missing();
  wire::PartialPacket partial{number, packet.attempt, first, {}};
  const std::size_t beyond = packet.assembly.known() > first + 1 ? packet.assembly.known() - first - 1 : 0;
  partial.received.assign(std::min((beyond + 7) / 8, kMostBitmapOctets), 0);
  for (std::size_t bit = 0; bit < std::min(beyond, 8 * partial.received.size()); ++bit) {
    if (packet.assembly.has(first + 1 + static_cast<std::uint32_t>(bit))) {
      partial.received[bit / 8] |= static_cast<std::uint8_t>(1 << bit % 8);
    }
  }
  return partial;
}

void StreamReceiver::expire(Time now) {
  for (std::size_t index = 0; index < streams_.size(); ++index) {
    Stream& stream = streams_[index];
    if (now - stream.last_segment < kAbandoned) continue;
    while (!stream.packets.empty()) drop(index, stream.packets.begin());
    stream.refused.clear();
  }
}

}  // namespace adhoc_communication::transport
