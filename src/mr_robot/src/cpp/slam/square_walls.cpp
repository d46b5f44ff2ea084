#include "square_walls.hpp"

#include <algorithm>
#include <cmath>

namespace mr_robot::slam {
namespace {

constexpr double kMostSpacing = 0.3;  // m along a wall for which one hit vouches
constexpr double kLeastLength = 3.0;  // m of surfaces, over all scans of the place
constexpr double kSquare = 0.8;       // of them that must agree, 1: all

}  // namespace

void SquareWalls::add(const Scan& scan, double yaw) {
  for (const Beam& beam : scan.beams) {
    if (!beam.has_normal || beam.on_small_object) continue;
    const double length = std::min(beam.spacing, kMostSpacing);
    sum_ += std::polar(length, 4.0 * (std::atan2(beam.normal.y, beam.normal.x) + yaw));
    length_ += length;
  }
}

std::optional<double> SquareWalls::direction() const {
  if (length_ < kLeastLength || std::abs(sum_) < kSquare * length_) return std::nullopt;
  return std::arg(sum_) / 4.0;
}

}  // namespace mr_robot::slam
