#include "raster.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace mr_sim {

namespace {

constexpr int kMaxClearance = 255;

// std::floor for coordinates at most kMaxClearance below zero, without its function call.
inline int cell_of(double coordinate) {
  return static_cast<int>(coordinate + (kMaxClearance + 1)) - (kMaxClearance + 1);
}

}  // namespace

Raster::Raster(const uint8_t* occupied, int rows, int columns, double resolution, Point origin,
               const float* intensities)
    : rows_(rows), columns_(columns), resolution_(resolution), origin_(origin) {
  if (rows < 1 || columns < 1) throw std::invalid_argument("a raster needs at least one cell");
  if (!(resolution > 0.0)) throw std::invalid_argument("the resolution of a raster must be positive");
  for (int quadrant = 0; quadrant < 4; ++quadrant) {
    measure_clearance(occupied, quadrant & 1 ? 1 : -1, quadrant & 2 ? 1 : -1, &clearance_[quadrant]);
  }
  if (intensities) intensities_.assign(intensities, intensities + static_cast<size_t>(rows) * columns);
}

// Side of the largest free square in a quadrant, by dynamic programming: one cell more than the least of the three
// neighbours in that direction. Outside the raster everything is free.
void Raster::measure_clearance(const uint8_t* occupied, int step_x, int step_y, std::vector<uint8_t>* clearance) {
  clearance->resize(static_cast<size_t>(rows_) * columns_);
  const auto at = [&](int row, int column) -> int {
    if (row < 0 || row >= rows_ || column < 0 || column >= columns_) return kMaxClearance;
    return (*clearance)[static_cast<size_t>(row) * columns_ + column];
  };
  for (int i = 0; i < rows_; ++i) {
    const int row = step_y > 0 ? rows_ - 1 - i : i;
    for (int j = 0; j < columns_; ++j) {
      const int column = step_x > 0 ? columns_ - 1 - j : j;
      const size_t cell = static_cast<size_t>(row) * columns_ + column;
      const int side = std::min(
          {at(row, column + step_x), at(row + step_y, column), at(row + step_y, column + step_x), kMaxClearance - 1});
      (*clearance)[cell] = occupied[cell] ? 0 : static_cast<uint8_t>(side + 1);
    }
  }
}

// Distance in cells at which a ray from outside enters the raster.
bool Raster::enter(double x, double y, const Point& direction, double limit, double* travelled) const {
  double first = 0.0;
  double last = limit;
  const auto clip = [&](double start, double step, double end) {
    if (step == 0.0) return start >= 0.0 && start < end;
    const double a = -start / step;
    const double b = (end - start) / step;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
    return first < last;
  };
  if (!clip(x, direction.x, columns_) || !clip(y, direction.y, rows_)) return false;
  *travelled = first;
  return true;
}

double Raster::cast(const Point& origin, const Point& direction, double max_range, float* intensity) const {
  if (intensity) *intensity = 0.0f;
  const double x = (origin.x - origin_.x) / resolution_;
  const double y = (origin.y - origin_.y) / resolution_;
  const double limit = max_range / resolution_;
  double travelled = 0.0;
  int column = static_cast<int>(std::floor(x));
  int row = static_cast<int>(std::floor(y));
  if (column < 0 || column >= columns_ || row < 0 || row >= rows_) {
    if (!enter(x, y, direction, limit, &travelled)) return max_range;
    column = std::clamp(static_cast<int>(std::floor(x + direction.x * travelled)), 0, columns_ - 1);
    row = std::clamp(static_cast<int>(std::floor(y + direction.y * travelled)), 0, rows_ - 1);
  }

  constexpr double never = std::numeric_limits<double>::infinity();
  const double inverse_x = direction.x != 0.0 ? 1.0 / direction.x : 0.0;
  const double inverse_y = direction.y != 0.0 ? 1.0 / direction.y : 0.0;
  const int step_x = direction.x > 0.0 ? 1 : -1;
  const int step_y = direction.y > 0.0 ? 1 : -1;
  const std::vector<uint8_t>& clearance = clearance_[(step_x > 0 ? 1 : 0) + (step_y > 0 ? 2 : 0)];
  while (travelled < limit) {
    if (column < 0 || column >= columns_ || row < 0 || row >= rows_) return max_range;
    const size_t cell = static_cast<size_t>(row) * columns_ + column;
    const int clear = clearance[cell];
    if (clear == 0) {
      if (intensity) *intensity = intensities_.empty() ? 1.0f : intensities_[cell];
      return travelled * resolution_;
    }
    // Go on where the ray leaves the free square ahead; with clear = 1 this is a DDA step.
    const int edge_x = step_x > 0 ? column + clear : column - clear + 1;
    const int edge_y = step_y > 0 ? row + clear : row - clear + 1;
    const double to_x = inverse_x != 0.0 ? (edge_x - x) * inverse_x : never;
    const double to_y = inverse_y != 0.0 ? (edge_y - y) * inverse_y : never;
    if (to_x < to_y) {
      travelled = to_x;
      column += step_x * clear;
      const int crossed = cell_of(y + direction.y * travelled);
      row = step_y > 0 ? std::clamp(crossed, row, row + clear - 1) : std::clamp(crossed, row - clear + 1, row);
    } else {
      travelled = to_y;
      row += step_y * clear;
      const int crossed = cell_of(x + direction.x * travelled);
      column = step_x > 0 ? std::clamp(crossed, column, column + clear - 1)
                          : std::clamp(crossed, column - clear + 1, column);
    }
  }
  return max_range;
}

bool Raster::touches(const Point& a, const Point& b) const {
  const Point span = b - a;
  const double length = std::hypot(span.x, span.y);
  if (length == 0.0) return occupied(a);
  return cast(a, {span.x / length, span.y / length}, length) < length;
}

bool Raster::occupied(const Point& point) const {
  const double column = std::floor((point.x - origin_.x) / resolution_);
  const double row = std::floor((point.y - origin_.y) / resolution_);
  if (column < 0 || column >= columns_ || row < 0 || row >= rows_) return false;
  return clearance_[0][static_cast<size_t>(row) * columns_ + static_cast<size_t>(column)] == 0;
}

}  // namespace mr_sim
