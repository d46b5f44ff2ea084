#include "payloads.hpp"

#include <array>

#include "random.hpp"

namespace adhoc_communication {

Bytes noise(std::size_t size, std::uint64_t seed) {
  Random random(seed);
  Bytes bytes(size);
  for (std::uint8_t& octet : bytes) octet = static_cast<std::uint8_t>(random.next() >> 32);
  return bytes;
}

Bytes map_like(std::size_t size) {
  Random random(7);
  Bytes bytes;
  while (bytes.size() < size) {
    const std::uint8_t value = std::array<std::uint8_t, 3>{0, 100, 255}[random.next() % 3];
    bytes.insert(bytes.end(), 20 + random.next() % 200, value);
  }
  bytes.resize(size);
  return bytes;
}

Bytes text(const std::string& characters) { return {characters.begin(), characters.end()}; }
std::string text(const Bytes& octets) { return {octets.begin(), octets.end()}; }

}  // namespace adhoc_communication
