#include "medium/walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace adhoc_communication {
namespace {

/// Cell by cell along one axis (Amanatides and Woo 1987). The line is parametrised from 0 at its begin to 1 at its end.
struct Axis {
  std::int64_t cell;  ///< index of the current cell
  std::int64_t step;  ///< to the next one
  double next;        ///< where the line leaves the current cell
  double span;        ///< of the line within one cell

  Axis(double begin, double end) : cell(static_cast<std::int64_t>(std::floor(begin))), step(end < begin ? -1 : 1) {
    const double length = std::abs(end - begin);
    const double ahead = step > 0 ? std::floor(begin) + 1.0 - begin : begin - std::floor(begin);
    span = length > 0 ? 1.0 / length : std::numeric_limits<double>::infinity();
    next = length > 0 ? ahead / length : std::numeric_limits<double>::infinity();
  }
  void advance() {
    cell += step;
    next += span;
  }
};

/// The part of the line, as parameters, whose coordinate lies within 0 .. size; nothing is left where begin > end.
void clip(double from, double to, double size, double& begin, double& end) {
  if (from == to) {
    if (from < 0.0 || from > size) end = -1.0;
    return;
  }
  const double at_zero = -from / (to - from);
  const double at_size = (size - from) / (to - from);
  begin = std::max(begin, std::min(at_zero, at_size));
  end = std::min(end, std::max(at_zero, at_size));
}

Position between(const Position& a, const Position& b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

int runs_of_walls(const Walls& walls, const Position& from, const Position& to) {
  Axis column(from.x, to.x);
  Axis row(from.y, to.y);
  int runs = 0;
  for (bool inside = false;;) {
    const bool occupied = walls.occupied(column.cell, row.cell);
    if (occupied && !inside) ++runs;
    inside = occupied;
    Axis& nearer = column.next < row.next ? column : row;
    if (!(nearer.next < 1.0)) return runs;
    nearer.advance();
  }
}

}  // namespace

bool Walls::occupied(std::int64_t column, std::int64_t row) const {
  const auto x = static_cast<std::uint64_t>(column);  // below zero becomes too large
  const auto y = static_cast<std::uint64_t>(row);
  if (x >= width || y >= cells.size()) return false;
  const std::uint64_t index = y * width + x;
  return index < cells.size() && cells[index] != 0;
}

int walls_between(const Walls& walls, const Position& a, const Position& b) {
  if (walls.cells.empty() || walls.width == 0) return 0;
  const auto in_cells = [&walls](const Position& position) {
    return Position{(position.x - walls.origin.x) / walls.resolution, (position.y - walls.origin.y) / walls.resolution};
  };
  Position from = in_cells(a);
  Position to = in_cells(b);
  if (std::pair(to.x, to.y) < std::pair(from.x, from.y)) std::swap(from, to);  // rounding, too, is the same both ways
  double begin = 0.0, end = 1.0;
  clip(from.x, to.x, static_cast<double>(walls.width), begin, end);
  clip(from.y, to.y, static_cast<double>(walls.cells.size() / walls.width), begin, end);
  if (!(begin <= end)) return 0;
  return runs_of_walls(walls, between(from, to, begin), between(from, to, end));
}

}  // namespace adhoc_communication
