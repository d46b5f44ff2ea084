#include "surface_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace map_merger {
namespace {

constexpr double kSmallestEdge = 0.1;     // m
constexpr double kBucketsPerPoint = 8.0;  // at most, so that sparse points take no memory for nothing

}  // namespace

SurfaceIndex::SurfaceIndex(std::vector<OrientedPoint> points, double normal_weight)
    : points_(std::move(points)), normal_weight_(normal_weight) {
  if (points_.empty()) return;
  const auto by_x = [](const OrientedPoint& a, const OrientedPoint& b) { return a.x < b.x; };
  const auto by_y = [](const OrientedPoint& a, const OrientedPoint& b) { return a.y < b.y; };
  const auto [left, right] = std::minmax_element(points_.begin(), points_.end(), by_x);
  const auto [bottom, top] = std::minmax_element(points_.begin(), points_.end(), by_y);
  low_x_ = left->x, low_y_ = bottom->y;
  const double width = right->x - low_x_, height = top->y - low_y_, most = kBucketsPerPoint * points_.size();
  edge_ = std::max({kSmallestEdge, std::sqrt(width * height / most), (width + height) / most});
  columns_ = bucket_of(right->x, low_x_) + 1, rows_ = bucket_of(top->y, low_y_) + 1;
  std::vector<std::size_t> buckets(points_.size());
  starts_.assign(static_cast<std::size_t>(rows_ * columns_) + 1, 0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    buckets[i] = static_cast<std::size_t>(bucket_of(points_[i].y, low_y_) * columns_ + bucket_of(points_[i].x, low_x_));
    ++starts_[buckets[i] + 1];
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  order_.resize(points_.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < points_.size(); ++i) order_[next[buckets[i]]++] = static_cast<std::uint32_t>(i);
}

std::ptrdiff_t SurfaceIndex::bucket_of(double coordinate, double low) const {
  return static_cast<std::ptrdiff_t>(std::floor((coordinate - low) / edge_));
}

std::ptrdiff_t SurfaceIndex::nearest(const OrientedPoint& query, double bound) const {
  Best best{bound * bound, -1};
  const double far = bound + edge_;
  if (!(query.x > low_x_ - far && query.x < low_x_ + columns_ * edge_ + far && query.y > low_y_ - far &&
        query.y < low_y_ + rows_ * edge_ + far)) {
    return -1;
  }
  const std::ptrdiff_t row = bucket_of(query.y, low_y_), column = bucket_of(query.x, low_x_);
  // Ring after ring of buckets, until all that are left lie farther away than the best point.
  for (std::ptrdiff_t ring = 0;; ++ring) {
    const double gap = static_cast<double>(ring - 1) * edge_;
    if (gap > 0.0 && gap * gap >= best.squared_distance) return best.number;
    look_into(row - ring, column - ring, column + ring, query, best);
    for (std::ptrdiff_t side = row - ring + 1; side < row + ring; ++side) {
      look_into(side, column - ring, column - ring, query, best);
      look_into(side, column + ring, column + ring, query, best);
    }
    if (ring > 0) look_into(row + ring, column - ring, column + ring, query, best);
  }
}

void SurfaceIndex::look_into(std::ptrdiff_t row, std::ptrdiff_t left, std::ptrdiff_t right, const OrientedPoint& query,
                             Best& best) const {
  left = std::max<std::ptrdiff_t>(left, 0), right = std::min(right, columns_ - 1);
  if (row < 0 || row >= rows_ || left > right) return;
  const std::uint32_t end = starts_[row * columns_ + right + 1];
  for (std::uint32_t i = starts_[row * columns_ + left]; i < end; ++i) {
    const OrientedPoint& point = points_[order_[i]];
    const double x = point.x - query.x, y = point.y - query.y;
    const double normal_x = point.normal_x - query.normal_x, normal_y = point.normal_y - query.normal_y;
    const double squared_distance =
        x * x + y * y + normal_weight_ * normal_weight_ * (normal_x * normal_x + normal_y * normal_y);
    if (squared_distance < best.squared_distance) best = {squared_distance, static_cast<std::ptrdiff_t>(order_[i])};
  }
}

}  // namespace map_merger
