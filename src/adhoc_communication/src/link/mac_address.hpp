// Hardware addresses as text and derived from robot names.
#pragma once

#include <optional>
#include <string>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

inline constexpr MacAddress kBroadcastAddress{0xff, 0xff, 0xff, 0xff, 0xff, 0xff};

/// Reads six pairs of hexadecimal digits with any single character between them, as 02:00:00:00:00:01.
/// Throws std::invalid_argument with one sentence when the text is anything else or a multicast address.
MacAddress parse_mac_address(const std::string& text);

std::string to_text(const MacAddress& address);

bool is_zero(const MacAddress& address);

/// The locally administered address of a robot whose interface has none of its own (lo, a hub socket). robot_<integer>
/// yields 02:72:<integer, 4 octets>, so that the name can be told from the address; any other name yields 06:<hash>.
MacAddress address_of_robot(const std::string& robot_name);

/// robot_<integer> if the address was derived from such a name.
std::optional<std::string> robot_of_address(const MacAddress& address);

/// The integer of a name of the form robot_<integer>.
std::optional<unsigned> robot_number(const std::string& robot_name);

}  // namespace adhoc_communication
