#include "raster.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace mr_sim {

Raster::Raster(const uint8_t* occupied, int rows, int columns, double resolution, Point origin)
    : rows_(rows), columns_(columns), resolution_(resolution), origin_(origin) {
  if (rows < 1 || columns < 1) throw std::invalid_argument("a raster needs at least one cell");
  if (!(resolution > 0.0)) throw std::invalid_argument("the resolution of a raster must be positive");
  measure_clearance(occupied);
}

// Two sweeps of the chessboard distance transform (Rosenfeld and Pfaltz 1966), exact for this metric.
void Raster::measure_clearance(const uint8_t* occupied) {
  const int width = columns_ + 2;
  std::vector<int> distance(static_cast<size_t>(width) * (rows_ + 2), 255);
  const auto at = [&](int row, int column) -> int& { return distance[(row + 1) * width + column + 1]; };
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const int nearest =
          std::min({at(row, column - 1), at(row - 1, column - 1), at(row - 1, column), at(row - 1, column + 1), 254});
      at(row, column) = occupied[static_cast<size_t>(row) * columns_ + column] ? 0 : nearest + 1;
    }
  }
  clearance_.resize(static_cast<size_t>(rows_) * columns_);
  for (int row = rows_ - 1; row >= 0; --row) {
    for (int column = columns_ - 1; column >= 0; --column) {
      const int nearest =
          std::min({at(row, column + 1), at(row + 1, column + 1), at(row + 1, column), at(row + 1, column - 1), 254});
      at(row, column) = std::min(at(row, column), nearest + 1);
      clearance_[static_cast<size_t>(row) * columns_ + column] = static_cast<uint8_t>(at(row, column));
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

double Raster::cast(const Point& origin, const Point& direction, double max_range) const {
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
  while (travelled < limit) {
    if (column < 0 || column >= columns_ || row < 0 || row >= rows_) return max_range;
    const int clear = clearance_[static_cast<size_t>(row) * columns_ + column];
    if (clear == 0) return travelled * resolution_;
    // The square of cells nearer than `clear` is free: go on where the ray leaves it. With clear = 1 this is a DDA
    // step.
    const int edge_x = step_x > 0 ? column + clear : column - clear + 1;
    const int edge_y = step_y > 0 ? row + clear : row - clear + 1;
    const double to_x = inverse_x != 0.0 ? (edge_x - x) * inverse_x : never;
    const double to_y = inverse_y != 0.0 ? (edge_y - y) * inverse_y : never;
    if (to_x < to_y) {
      travelled = to_x;
      column += step_x * clear;
      const int crossed = static_cast<int>(std::floor(y + direction.y * travelled));
      row = std::clamp(crossed, row - clear + 1, row + clear - 1);
    } else {
      travelled = to_y;
      row += step_y * clear;
      const int crossed = static_cast<int>(std::floor(x + direction.x * travelled));
      column = std::clamp(crossed, column - clear + 1, column + clear - 1);
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
  return clearance_[static_cast<size_t>(row) * columns_ + static_cast<size_t>(column)] == 0;
}

}  // namespace mr_sim
