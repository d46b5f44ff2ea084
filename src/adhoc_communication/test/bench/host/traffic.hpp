// Payloads that do not compress, and what tells them apart.
#pragma once

#include <cstddef>
#include <cstdint>

#include "adhoc_communication/types.hpp"
#include "random.hpp"

namespace adhoc_communication::bench {

inline Bytes incompressible(std::size_t octets, std::uint64_t seed) {
  Random random(seed);
  Bytes payload(octets);
  for (std::uint8_t& octet : payload) octet = static_cast<std::uint8_t>(random.next() >> 32);
  return payload;
}

/// FNV-1a.
inline std::uint64_t digest(const Bytes& octets) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::uint8_t octet : octets) hash = (hash ^ octet) * 0x100000001b3u;
  return hash;
}

}  // namespace adhoc_communication::bench
