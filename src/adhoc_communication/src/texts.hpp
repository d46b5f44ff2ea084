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

}  // namespace adhoc_communication
