// Every reader of frame bodies on arbitrary octets. The first octet selects the reader, the others are the body.
#include <cstdint>
#include <cstdlib>

#include "multicast/groups.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

/// What was read and is written again reads as the same message.
template <typename Read>
void check_body(const Bytes& body, Read read) {
  const auto message = read(wire::Reader(body));
  if (!message) return;
  const Bytes written = wire::to_bytes(*message);
  const auto again = read(wire::Reader(written));
  if (!again || wire::to_bytes(*again) != written) std::abort();
}

void check_header(const Bytes& octets) {
  wire::Reader reader(octets);
  const auto header = wire::read_header(reader);
  if (!header) return;
  Bytes written;
  wire::Writer writer(written);
  write(writer, *header);
  if (written != Bytes(octets.begin(), octets.begin() + wire::kHeaderSize)) std::abort();
}

/// A frame that opens is the one that closing its parts gives.
void check_frame(const Bytes& frame) {
  auto body = wire::open_body(frame);
  wire::Reader reader(frame);
  const auto header = wire::read_header(reader);
  if (!body || !header) return;
  if (wire::close_openly(*header, body->rest()) != frame) std::abort();
}

void check_members(const Bytes& payload) {
  const auto members = multicast::decode_members(payload);
  if (!members) return;
  const std::set<std::string> names(members->begin(), members->end());
  if (multicast::decode_members(multicast::encode_members(names))->size() != names.size()) std::abort();
}

void check_copy(const Bytes& payload) {
  const auto copy = multicast::decode_copy(payload);
  if (copy && copy->image.size() > payload.size()) std::abort();
}

void check(std::uint8_t reader, const Bytes& octets) {
  switch (reader % 18) {
    case 0:
      return check_header(octets);
    case 1:
      return check_body(octets, wire::read_beacon);
    case 2:
      return check_body(octets, wire::read_route_request);
    case 3:
      return check_body(octets, wire::read_route_reply);
    case 4:
      return check_body(octets, wire::read_route_error);
    case 5:
      return check_body(octets, wire::read_hop_acknowledgment);
    case 6:
      return check_body(octets, wire::read_data);
    case 7:
      return check_body(octets, wire::read_transport_acknowledgment);
    case 8:
      return check_body(octets, wire::read_broadcast_data);
    case 9:
      return check_body(octets, wire::read_flood);
    case 10:
      return check_members(octets);
    case 11:
      return check_frame(octets);
    case 12:
      return check_body(octets, wire::read_group_activation);
    case 13:
      return check_body(octets, wire::read_group_refusal);
    case 14:
      return check_body(octets, wire::read_group_data);
    case 15:
      return check_body(octets, wire::read_group_report);
    case 16:
      return check_copy(octets);
    case 17:
      return check_body(octets, wire::read_group_receipts);
  }
}

}  // namespace
}  // namespace adhoc_communication

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) adhoc_communication::check(data[0], adhoc_communication::Bytes(data + 1, data + size));
  return 0;
}
