// Values of the cells of a map.
#pragma once

#include <cstdint>

namespace map_merger {

constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;
// Cells of at least this value are obstacles, those from 0 on are free.
constexpr std::int8_t kOccupiedFrom = 50;

}  // namespace map_merger
