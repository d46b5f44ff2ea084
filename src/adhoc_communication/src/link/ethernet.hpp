// The Ethernet header around a frame: destination, source, ethertype.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// IEEE 802 local experimental ethertype 1 (IEEE Std 802-2014, 9.2.4).
inline constexpr std::uint16_t kEthertype = 0x88B5;
inline constexpr std::size_t kEthernetHeaderSize = 14;

using EthernetHeader = std::array<std::uint8_t, kEthernetHeaderSize>;

EthernetHeader ethernet_header(const Frame& frame);

/// The octets on the wire, header first.
Bytes to_wire(const Frame& frame);

/// False when the octets are shorter than the header or carry another ethertype. Uses the memory that `frame` has.
bool from_wire(const std::uint8_t* octets, std::size_t size, Frame& frame);
std::optional<Frame> from_wire(const std::uint8_t* octets, std::size_t size);

}  // namespace adhoc_communication
