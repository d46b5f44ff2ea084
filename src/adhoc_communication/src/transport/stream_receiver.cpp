#include "transport/stream_receiver.hpp"

#include <algorithm>

#include "routing/sequence_number.hpp"

namespace adhoc_communication::transport {
namespace {

constexpr std::size_t kMostPartialOctets = 256;  ///< of an acknowledgment, so that it fits any link
constexpr std::size_t kMostBitmapOctets = 128;   ///< 1024 segments beyond the first missing one
constexpr std::size_t kPartialOctets = 9;        ///< of a partial packet besides its bitmap

}  // namespace

StreamReceiver::~StreamReceiver() {
  for (Stream& stream : streams_) {
    while (!stream.assemblies.empty()) drop(stream, stream.assemblies.begin());
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
  stream.last_segment = now;
  if (routing::is_newer(data.base, stream.next)) {
    move_base(stream, data.base);
    deliver(stream, complete);
  }
  const bool fresh = store(stream, data);
  deliver(stream, complete);
  if (fresh) ++stream.unacknowledged;
  const bool now_due =
      data.acknowledge_now || !fresh || !complete.empty() || stream.unacknowledged >= kSegmentsPerAcknowledgment;
  stream.due = std::min(stream.due, now_due ? now : now + kLongestDelay);
  return complete;
}

bool StreamReceiver::store(Stream& stream, const wire::Data& data) {
  if (data.packet - stream.next >= kPacketsAhead) return false;
  auto found = stream.assemblies.find(data.packet);
  if (found == stream.assemblies.end()) {
    const std::uint32_t count = (data.total + data.segment_size - 1) / data.segment_size;
    if (data.index >= kSegmentsAhead) return false;
    Assembly assembly;
    assembly.total = data.total;
    assembly.segment_size = data.segment_size;
    assembly.missing = count;
    found = stream.assemblies.emplace(data.packet, std::move(assembly)).first;
  }
  Assembly& assembly = found->second;
  if (assembly.total != data.total || assembly.segment_size != data.segment_size) return false;
  if (data.index < assembly.present.size() && assembly.present[data.index]) return false;
  if (data.index > assembly.first_missing && data.index - assembly.first_missing >= kSegmentsAhead) return false;
  // Room grows with what arrives, so a single forged segment cannot claim the memory of a whole packet.
  const std::size_t begin = std::size_t{data.index} * data.segment_size;
  const std::size_t end = begin + data.octets.size();
  if (end > assembly.octets.size()) {
    if (!budget_.take(end - assembly.octets.size())) return false;
    assembly.octets.resize(end);
  }
  if (data.index >= assembly.present.size()) assembly.present.resize(data.index + 1);
  std::copy(data.octets.begin(), data.octets.end(), assembly.octets.begin() + static_cast<std::ptrdiff_t>(begin));
  assembly.present[data.index] = true;
  assembly.hops = std::max(assembly.hops, data.hops);
  --assembly.missing;
  while (assembly.first_missing < assembly.present.size() && assembly.present[assembly.first_missing]) {
    ++assembly.first_missing;
  }
  return true;
}

void StreamReceiver::drop(Stream& stream, std::map<std::uint32_t, Assembly>::iterator assembly) {
  budget_.give_back(assembly->second.octets.size());
  stream.assemblies.erase(assembly);
}

/// The sender has given up what comes before `base`.
void StreamReceiver::move_base(Stream& stream, std::uint32_t base) {
  for (auto iterator = stream.assemblies.begin(); iterator != stream.assemblies.end();) {
    const auto assembly = iterator++;
    if (routing::is_newer(base, assembly->first)) drop(stream, assembly);
  }
  stream.next = base;
}

void StreamReceiver::deliver(Stream& stream, std::vector<Complete>& out) {
  for (auto found = stream.assemblies.find(stream.next); found != stream.assemblies.end() && found->second.missing == 0;
       found = stream.assemblies.find(stream.next)) {
    budget_.give_back(found->second.octets.size());
    out.push_back({std::move(found->second.octets), found->second.hops});
    stream.assemblies.erase(found);
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
  std::vector<std::uint32_t> numbers;
  for (const auto& [number, assembly] : stream.assemblies) numbers.push_back(number);
  std::sort(numbers.begin(), numbers.end(),
            [&](std::uint32_t a, std::uint32_t b) { return a - stream.next < b - stream.next; });
  std::size_t octets = 0;
  for (const std::uint32_t number : numbers) {
    const Assembly& assembly = stream.assemblies.at(number);
    wire::PartialPacket partial{number, assembly.first_missing, {}};
    const std::size_t beyond =
        assembly.present.size() > assembly.first_missing + 1 ? assembly.present.size() - assembly.first_missing - 1 : 0;
    partial.received.assign(std::min((beyond + 7) / 8, kMostBitmapOctets), 0);
    for (std::size_t bit = 0; bit < std::min(beyond, 8 * partial.received.size()); ++bit) {
      if (assembly.present[assembly.first_missing + 1 + bit]) {
        partial.received[bit / 8] |= static_cast<std::uint8_t>(1 << bit % 8);
      }
    }
    octets += kPartialOctets + partial.received.size();
    if (octets > kMostPartialOctets) break;
    acknowledgment.partial.push_back(std::move(partial));
  }
  return acknowledgment;
}

void StreamReceiver::expire(Time now) {
  for (Stream& stream : streams_) {
    if (now - stream.last_segment < kAbandoned) continue;
    while (!stream.assemblies.empty()) drop(stream, stream.assemblies.begin());
  }
}

}  // namespace adhoc_communication::transport
