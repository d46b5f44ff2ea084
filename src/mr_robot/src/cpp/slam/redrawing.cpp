#include "redrawing.hpp"

#include <utility>

namespace mr_robot::slam {
namespace {

constexpr double kDrawnAtOnce = 60'000.0;  // m of beams that are drawn anew with each scan that comes, and
constexpr int kScansAtOnce = 100;          // scans

}  // namespace

Redrawing::Redrawing(const GridOptions& grid, const GridMap& former, std::vector<Pose> poses)
    : map_(grid), poses_(std::move(poses)) {
  map_.cover(former);
}

Pose Redrawing::target(const Keyframes& keyframes, std::size_t keyframe) const {
  if (keyframe < poses_.size()) return poses_[keyframe];
  const std::size_t last = poses_.size() - 1;
  return poses_[last] * between(keyframes[last].drawn, keyframes[keyframe].drawn);
}

bool Redrawing::step(const Keyframes& keyframes) {
  const double most = map_.walked() + kDrawnAtOnce;
  for (int done = 0; done < kScansAtOnce && keyframe_ < keyframes.size(); ++done) {
    if (map_.walked() > most) break;
    const Keyframe& keyframe = keyframes[keyframe_];
    const Kept& kept = keyframe.scans[scan_++];
    map_.insert(keyframes.scan_of(kept), target(keyframes, keyframe_) * kept.relative, static_cast<int>(keyframe_));
    if (scan_ == keyframe.scans.size()) ++keyframe_, scan_ = 0;
  }
  return keyframe_ == keyframes.size();
}

}  // namespace mr_robot::slam
