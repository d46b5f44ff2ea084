#include "transport/outgoing_packet.hpp"

namespace adhoc_communication::transport {

void SentSegment::leaves(Time now) {
  sent = now;
  if (first_sent < Time(0)) {
    first_sent = now;
  } else {
    ++repetitions;
  }
}

void OutgoingPacket::cut(std::uint16_t size) {
  segment_size = size;
  segments.resize((image->size() + size - 1) / size);
  begin_anew();
}

void OutgoingPacket::begin_anew() {
  segments.assign(segments.size(), SentSegment{});
  started = 0;
  first_open = 0;
}

void OutgoingPacket::drop() {
  segments.clear();
  begin_anew();
  refused_since.reset();
  image.reset();
  dropped = true;
}

wire::Data OutgoingPacket::data(std::uint8_t stream, std::uint32_t index) const {
  wire::Data data;
  data.stream = stream;
  data.packet = number;
  data.index = index;
  data.total = static_cast<std::uint32_t>(image->size());
  data.segment_size = segment_size;
  data.attempt = attempt;
  const std::size_t begin = std::size_t{index} * segment_size;
  const std::size_t end = std::min(begin + segment_size, image->size());
  data.octets.assign(image->begin() + static_cast<std::ptrdiff_t>(begin),
                     image->begin() + static_cast<std::ptrdiff_t>(end));
  return data;
}

std::vector<std::uint32_t> OutgoingPacket::newly_received(const wire::PartialPacket& partial) const {
  const auto count = static_cast<std::uint32_t>(segments.size());
  std::vector<std::uint32_t> received;
  for (std::uint32_t index = first_open; index < std::min(partial.first_missing, count); ++index) {
    received.push_back(index);
  }
  for (std::size_t bit = 0; bit < 8 * partial.received.size(); ++bit) {
    const std::uint64_t index = std::uint64_t{partial.first_missing} + 1 + bit;
    if (index >= count) break;
    if ((partial.received[bit / 8] >> bit % 8 & 1) != 0) received.push_back(static_cast<std::uint32_t>(index));
  }
  return received;
}

void OutgoingPacket::pass_over_acknowledged() {
  while (first_open < segments.size() && segments[first_open].acknowledged) ++first_open;
}

}  // namespace adhoc_communication::transport
