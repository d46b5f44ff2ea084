#include "far_loop.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kRivalsWithin = 2.0;  // times the window, for other places that are as good
constexpr std::size_t kLeastSeen = 100;

}  // namespace

FarLoop::FarLoop(const GridOptions& grid, const MatchOptions& options, std::size_t keyframe, const Pose& expected,
                 const Pose& window)
    : keyframe_(keyframe), expected_(expected), window_(window), old_(grid), finder_(options) {}

void FarLoop::see(std::vector<Scan> scans) {
  seen_ = std::move(scans);
  if (waits_) finder_.ask_again();
  waits_ = false;
}

std::optional<Match> FarLoop::work() {
  if (waits_ || failed_ || !whole_ || !finder_.prepare(old_)) return std::nullopt;
  if (!begun_) {
    std::vector<Feature> features;
    for (const Scan& scan : seen_) {
      for (const Beam& beam : scan.beams) features.push_back({beam.end, beam.normal});
    }
    failed_ = features.size() < kLeastSeen;
    begun_ = true;
    if (!failed_)
      finder_.begin(features, expected_, {kRivalsWithin * window_.x, kRivalsWithin * window_.y, window_.yaw});
    return std::nullopt;
  }
  const auto match = finder_.step(old_, seen_, [this](const Pose& place) {
    return std::abs(place.x - expected_.x) <= window_.x && std::abs(place.y - expected_.y) <= window_.y;
  });
  if (match || !finder_.idle()) return match;
  waits_ = finder_.asks_again();
  failed_ = !waits_;
  return std::nullopt;
}

}  // namespace mr_robot::slam
