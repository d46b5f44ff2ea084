// Numbers as people read them.
#pragma once

#include <cstdio>
#include <string>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

inline std::string seconds_text(Time time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", static_cast<double>(time.count()) * 1e-9);
  return text;
}

inline std::string size_text(std::size_t octets) {
  char text[32];
  if (octets >= 1'000'000) {
    std::snprintf(text, sizeof text, "%.1f MB", static_cast<double>(octets) * 1e-6);
  } else {
    std::snprintf(text, sizeof text, "%.1f kB", static_cast<double>(octets) * 1e-3);
  }
  return text;
}

/// As the contract writes the address of a robot without name.
inline std::string address_text(const MacAddress& address) {
  char text[18];
  std::snprintf(text, sizeof text, "%02X-%02X-%02X-%02X-%02X-%02X", address[0], address[1], address[2], address[3],
                address[4], address[5]);
  return text;
}

/// Words from the air for a log or a terminal: what is not visible ASCII or a blank is shown as its number.
inline std::string escaped(const std::string& words) {
  std::string text;
  for (const char character : words) {
    char number[8];
    std::snprintf(number, sizeof number, "\\x%02x", static_cast<unsigned char>(character));
    text += character >= ' ' && character <= '~' && character != '\\' ? std::string(1, character) : number;
  }
  return text;
}

/// Of what cannot be the name of a robot.
inline std::string no_name_text(const std::string& words) {
  constexpr std::size_t kShown = 80;
  return "'" + escaped(words.substr(0, kShown)) + (words.size() > kShown ? "..." : "") +
         "' cannot be the name of a robot: it has no more than 64 letters, digits or signs and no blank";
}

}  // namespace adhoc_communication
