#pragma once

#include <cstddef>

namespace adhoc_communication::transport {

/// As many as Priority has values.
constexpr std::size_t kPriorities = 4;

}  // namespace adhoc_communication::transport
