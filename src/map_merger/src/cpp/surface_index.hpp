// Search for the nearest like-facing point of a surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "oriented_point.hpp"

namespace map_merger {

// Points in buckets by their position. The distance of two points also counts how far their normals differ.
class SurfaceIndex {
 public:
  // `normal_weight`: metres that a unit difference of the normals counts.
  SurfaceIndex(std::vector<OrientedPoint> points, double normal_weight);

  // Number of the point nearest to `query` among those nearer than `bound` metres, -1 if there is none.
  std::ptrdiff_t nearest(const OrientedPoint& query, double bound) const;

  double normal_weight() const { return normal_weight_; }
  std::size_t size() const { return points_.size(); }
  const OrientedPoint& operator[](std::size_t number) const { return points_[number]; }

 private:
  struct Best {
    double squared_distance;
    std::ptrdiff_t number;
  };

  std::ptrdiff_t bucket_of(double coordinate, double low) const;
  void look_into(std::ptrdiff_t row, std::ptrdiff_t left, std::ptrdiff_t right, const OrientedPoint& query,
                 Best& best) const;

  std::vector<OrientedPoint> points_;
  double normal_weight_;
  double edge_ = 1.0, low_x_ = 0.0, low_y_ = 0.0;  // m
  std::ptrdiff_t rows_ = 0, columns_ = 0;
  std::vector<std::uint32_t> order_;   // numbers of the points, bucket by bucket
  std::vector<std::uint32_t> starts_;  // of the buckets in `order_`, row by row, and the end
};

}  // namespace map_merger
