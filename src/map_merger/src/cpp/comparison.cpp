#include "comparison.hpp"

#include <cmath>

#include "refinement.hpp"

namespace map_merger {
namespace {

// Of the distance from the partner's line, for a point (arm_x, arm_y) m away from where the transform puts the origin.
void add_information(const OrientedPoint& partner, double arm_x, double arm_y, std::array<double, 6>& sum) {
  const double x = partner.normal_x, y = partner.normal_y, yaw = arm_x * y - arm_y * x;
  sum[0] += x * x, sum[1] += x * y, sum[2] += x * yaw;
  sum[3] += y * y, sum[4] += y * yaw;
  sum[5] += yaw * yaw;
}

}  // namespace

Comparison compare(const SurfaceIndex& target, const Raster& known, const std::uint8_t* clear,
                   const std::vector<OrientedPoint>& source, const std::uint8_t* solid, const Pose& transform,
                   double tolerance) {
  Comparison result;
  const Frame to_target(transform), to_cells(inverse(known.origin));
  double xx = 0.0, xy = 0.0, yy = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const OrientedPoint moved = to_target * source[i], cell = to_cells * moved;
    const double row = std::floor(cell.y / known.resolution), column = std::floor(cell.x / known.resolution);
    if (!(row >= 0.0 && row < known.rows && column >= 0.0 && column < known.columns)) continue;
    const int r = static_cast<int>(row), c = static_cast<int>(column);
    if (!known.at(r, c)) continue;
    ++result.inside;
    const std::ptrdiff_t partner = partner_of(target, moved, tolerance);
    if (partner < 0) {
      result.contradicted += clear[known.index(r, c)] && solid[i];
      continue;
    }
    ++result.matched;
    xx += moved.normal_x * moved.normal_x, xy += moved.normal_x * moved.normal_y, yy += moved.normal_y * moved.normal_y;
    const OrientedPoint& found = target[partner];
    const double residual = (moved.x - found.x) * found.normal_x + (moved.y - found.y) * found.normal_y;
    squares += residual * residual;
    add_information(found, moved.x - transform.x, moved.y - transform.y, result.information);
    result.middle_x += moved.x, result.middle_y += moved.y;
  }
  result.minor = 0.5 * (xx + yy) - std::hypot(0.5 * (xx - yy), xy);
  if (result.matched == 0) return result;
  const double count = static_cast<double>(result.matched);
  result.mean_square = squares / count;
  result.middle_x /= count, result.middle_y /= count;
  return result;
}

}  // namespace map_merger
