// RFC 3561 section 6.1: sequence numbers wrap; which of two is newer is the sign of their difference.
#pragma once

#include <cstdint>

namespace adhoc_communication::routing {

inline bool is_newer(std::uint32_t number, std::uint32_t than) { return static_cast<std::int32_t>(number - than) > 0; }

/// Order of numbers less than half of all apart, also across the wrap.
struct SequenceOrder {
  bool operator()(std::uint32_t a, std::uint32_t b) const { return is_newer(b, a); }
};

inline std::uint32_t newest(std::uint32_t a, std::uint32_t b) { return is_newer(b, a) ? b : a; }

}  // namespace adhoc_communication::routing
