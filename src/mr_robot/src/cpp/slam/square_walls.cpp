#include "square_walls.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace mr_robot::slam {
namespace {

constexpr double kMostSpacing = 0.3;  // m along a wall for which one hit vouches
constexpr double kLeastLength = 3.0;  // m of surfaces, over all scans of the place
constexpr double kSquareShare = 0.8;  // of them that must agree, 1: all
constexpr double kAlong = 0.08;       // rad from the direction within which surfaces have a say in it
constexpr int kDirectionSteps = 5;
constexpr double kQuarterTurn = M_PI / 2.0;

}  // namespace

double SquareWalls::middle(std::size_t bin) { return (static_cast<double>(bin) + 0.5) * kQuarterTurn / kBins; }

void SquareWalls::add(const Scan& scan, double yaw) {
  for (const Beam& beam : scan.beams) {
    if (!beam.has_normal || beam.on_small_object) continue;
    const double length = std::min(beam.spacing, kMostSpacing);
    const double turn = (std::atan2(beam.normal.y, beam.normal.x) + yaw) / kQuarterTurn;
    const double angle = (turn - std::floor(turn)) * kQuarterTurn;
    const auto bin = std::min(static_cast<std::size_t>(angle / kQuarterTurn * kBins), kBins - 1);
    bins_[bin].length += static_cast<float>(length);
    bins_[bin].turned += static_cast<float>(length * (angle - middle(bin)));
  }
}

std::optional<double> SquareWalls::direction() const {
  double all = 0.0;
  std::complex<double> sum = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    all += bins_[bin].length;
    sum += std::polar<double>(bins_[bin].length, 4.0 * middle(bin));
  }
  if (all < kLeastLength || std::abs(sum) < kSquareShare * all) return std::nullopt;
  double direction = std::arg(sum) / 4.0;
  for (int iteration = 0; iteration < kDirectionSteps; ++iteration) {
    double along = 0.0, turned = 0.0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      const double off = std::remainder(middle(bin) - direction, kQuarterTurn);
      if (std::abs(off) > kAlong) continue;
      along += bins_[bin].length;
      turned += bins_[bin].turned + off * bins_[bin].length;
    }
    if (along == 0.0) return std::nullopt;
    direction += turned / along;
  }
  return std::remainder(direction, kQuarterTurn);
}

}  // namespace mr_robot::slam
