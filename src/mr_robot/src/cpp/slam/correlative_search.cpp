#include "correlative_search.hpp"

#include <algorithm>
#include <cstdint>

namespace mr_robot::slam {
namespace {

constexpr std::size_t kMostSearched = 120;  // hits

// The cells of a map that have a surface, one byte each.
class Raster {
 public:
  Raster(const GridMap& map, const Cell& low, const Cell& high)
      : low_(low), width_(high.x - low.x + 1), bytes_(static_cast<std::size_t>(width_) * (high.y - low.y + 1)) {
    map.visit_marked(low, high, [this](const Cell& cell) { bytes_[index_of(cell)] = 1; });
  }
  // Of this cell and those to the right of it.
  const uint8_t* from(const Cell& cell) const { return &bytes_[index_of(cell)]; }

 private:
  std::size_t index_of(const Cell& cell) const {
    return static_cast<std::size_t>(cell.y - low_.y) * width_ + cell.x - low_.x;
  }

  Cell low_;
  int width_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

Pose correlative_search(const GridMap& map, const std::vector<const Beam*>& beams, const Pose& center,
                        const Pose& window) {
  const double step = map.resolution(), turn_step = 0.025;
  const int steps = static_cast<int>(std::ceil(window.x / step)), side = 2 * steps + 1;
  const int turns = static_cast<int>(std::ceil(window.yaw / turn_step));
  const std::size_t stride = std::max<std::size_t>(4, beams.size() / kMostSearched);
  double far = 0.0;  // m from the robot, of the hits
  for (std::size_t i = 0; i < beams.size(); i += stride) {
    far = std::max(far, length_of(beams[i]->end.x, beams[i]->end.y));
  }
  const Cell low = map.cell_of({center.x - far, center.y - far}), high = map.cell_of({center.x + far, center.y + far});
  const int margin = steps + 1;
  const Raster raster(map, {low.x - margin, low.y - margin}, {high.x + margin, high.y + margin});
  Pose best = center;
  double best_score = -1.0;
  std::vector<uint8_t> on(static_cast<std::size_t>(side) * side);  // less than twice `kMostSearched` each
  for (int turn = -turns; turn <= turns; ++turn) {
    const Pose turned{center.x, center.y, normalized(center.yaw + turn * turn_step)};
    const Frame frame(turned);
    std::fill(on.begin(), on.end(), 0);
    for (std::size_t i = 0; i < beams.size(); i += stride) {
      const Cell cell = map.cell_of(frame * beams[i]->end);
      for (int dy = -steps; dy <= steps; ++dy) {
        const uint8_t* row = raster.from({cell.x - steps, cell.y + dy});
        uint8_t* sums = &on[static_cast<std::size_t>(dy + steps) * side];
        for (int dx = 0; dx < side; ++dx) sums[dx] = static_cast<uint8_t>(sums[dx] + row[dx]);
      }
    }
    for (int dy = -steps; dy <= steps; ++dy) {
      for (int dx = -steps; dx <= steps; ++dx) {
        // Ties go to the pose nearest to the expectation.
        const double off = 1e-3 * (dx * dx + dy * dy) + 1e-2 * turn * turn;
        const double score = on[static_cast<std::size_t>(dy + steps) * side + dx + steps] - off;
        if (score <= best_score) continue;
        best_score = score;
        best = {center.x + dx * step, center.y + dy * step, turned.yaw};
      }
    }
  }
  return best;
}

}  // namespace mr_robot::slam
