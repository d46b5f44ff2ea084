#include "link/mac_address.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <stdexcept>

namespace adhoc_communication {
namespace {

constexpr std::uint8_t kNumberedPrefix[2] = {0x02, 0x72};
constexpr std::uint8_t kHashedPrefix = 0x06;

std::uint64_t fnv1a(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const unsigned char character : text) hash = (hash ^ character) * 1099511628211ull;
  return hash;
}

}  // namespace

MacAddress parse_mac_address(const std::string& text) {
  constexpr std::size_t kLength = 17;
  bool well_formed = text.size() == kLength;
  MacAddress address{};
  for (std::size_t i = 0; well_formed && i < address.size(); ++i) {
    const char* begin = text.data() + 3 * i;
    const auto [end, error] = std::from_chars(begin, begin + 2, address[i], 16);
    well_formed = error == std::errc() && end == begin + 2;
  }
  if (!well_formed) throw std::invalid_argument("'" + text + "' is not a hardware address such as 02:00:00:00:00:01");
  if (address[0] & 1) throw std::invalid_argument("'" + text + "' is a multicast address and cannot be that of a node");
  if (is_zero(address)) throw std::invalid_argument("'" + text + "' cannot be the address of a node");
  return address;
}

std::string to_text(const MacAddress& address) {
  char text[18];
  std::snprintf(text, sizeof text, "%02x:%02x:%02x:%02x:%02x:%02x", address[0], address[1], address[2], address[3],
                address[4], address[5]);
  return text;
}

bool is_zero(const MacAddress& address) {
  return std::all_of(address.begin(), address.end(), [](std::uint8_t octet) { return octet == 0; });
}

MacAddress address_of_robot(const std::string& robot_name) {
  MacAddress address{};
  if (const auto number = robot_number(robot_name)) {
    std::copy(std::begin(kNumberedPrefix), std::end(kNumberedPrefix), address.begin());
    for (int i = 0; i < 4; ++i) address[2 + i] = static_cast<std::uint8_t>(*number >> (8 * (3 - i)));
    return address;
  }
  const std::uint64_t hash = fnv1a(robot_name);
  address[0] = kHashedPrefix;
  for (int i = 0; i < 5; ++i) address[1 + i] = static_cast<std::uint8_t>(hash >> (8 * i));
  return address;
}

std::optional<std::string> robot_of_address(const MacAddress& address) {
  if (!std::equal(std::begin(kNumberedPrefix), std::end(kNumberedPrefix), address.begin())) return std::nullopt;
  unsigned number = 0;
  for (int i = 0; i < 4; ++i) number = number << 8 | address[2 + i];
  return "robot_" + std::to_string(number);
}

std::optional<unsigned> robot_number(const std::string& robot_name) {
  const std::string prefix = "robot_";
  if (robot_name.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  unsigned number = 0;
  const char* end = robot_name.data() + robot_name.size();
  const auto [parsed_end, error] = std::from_chars(robot_name.data() + prefix.size(), end, number);
  if (error != std::errc() || parsed_end != end) return std::nullopt;
  return number;
}

}  // namespace adhoc_communication
