// Squares of the plane, to keep one point of each.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace mr_robot::navigation {

// Numbers the squares of the plane that points lie in, in the order in which they come.
class Squares {
 public:
  Squares(double size, std::size_t most) : size_(size) {
    std::size_t slots = 16;
    while (slots < 2 * most) slots *= 2;
    slots_.assign(slots, {0, 0, kNone});
  }

  // The number of the point's square; as many as there were before if it is new.
  std::size_t number(double x, double y) {
    const auto column = static_cast<std::int64_t>(std::floor(x / size_));
    const auto row = static_cast<std::int64_t>(std::floor(y / size_));
    const std::uint64_t hash = (static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15U) ^
                               (static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4FU);
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (hash >> 20) & mask;
    while (slots_[slot].number != kNone && (slots_[slot].column != column || slots_[slot].row != row)) {
      slot = (slot + 1) & mask;
    }
    if (slots_[slot].number == kNone) slots_[slot] = {column, row, count_++};
    return slots_[slot].number;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  struct Slot {
    std::int64_t column, row;
    std::size_t number;
  };
  double size_;
  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

}  // namespace mr_robot::navigation
