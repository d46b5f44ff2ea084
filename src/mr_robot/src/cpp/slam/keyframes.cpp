#include "keyframes.hpp"

#include <algorithm>
#include <stdexcept>

#include "place_finder.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kLately = 3.0;           // m of way that are compared with what was drawn long ago
constexpr long kMostAround = 40;          // keyframes, and
constexpr double kNearHere = 10.0;        // m from here, that say what was drawn long ago
constexpr double kLoopWay = 15.0;         // m since what was drawn long ago
constexpr double kFarLately = 8.0;        // m of way that are compared with that,
constexpr std::size_t kMostLately = 60;   // keyframes at most: a robot may turn on the spot for good
constexpr std::size_t kEveryOldScan = 3;  // of the scans of a keyframe, that are drawn for it, and
constexpr double kMostCells = 64e6;       // of a map that is recalled

}  // namespace

void Keyframes::open(const Pose& pose, const Pose& odometry, const Way& way) {
  keyframes_.push_back({pose, odometry, way, {}, {}, {}, {}});
}

void Keyframes::keep(std::vector<float> ranges, const Scan& scan, const LaserGeometry& geometry, const Pose& pose) {
  Keyframe& keyframe = keyframes_.back();
  const Pose relative = between(keyframe.drawn, pose);
  keyframe.scans.push_back({std::move(ranges), geometry, relative});
  keyframe.hits.add(scan, relative);
  keyframe.edges.add(scan, relative, options_.small_object_size);
  keyframe.walls.add(scan, relative.yaw);
}

Scan Keyframes::scan_of(const std::vector<float>& ranges, const LaserGeometry& geometry) const {
  return make_scan(ranges.data(), ranges.size(), geometry, options_);
}

void Keyframes::go_on(double distance) {
  const int last = static_cast<int>(keyframes_.size()) - 1;
  while (long_ago_ < last && distance - keyframes_[long_ago_ + 1].way.distance > kLoopWay) ++long_ago_;
}

void Keyframes::draw(GridMap* map) const {
  Pose low, high;
  for (const Keyframe& keyframe : keyframes_) {
    const double reach = keyframe.hits.reach();
    low = {std::min(low.x, keyframe.drawn.x - reach), std::min(low.y, keyframe.drawn.y - reach), 0.0};
    high = {std::max(high.x, keyframe.drawn.x + reach), std::max(high.y, keyframe.drawn.y + reach), 0.0};
  }
  if ((high.x - low.x) * (high.y - low.y) > kMostCells * grid_.resolution * grid_.resolution) {
    throw std::length_error("the map would have too many cells");
  }
  std::vector<GridMap::Disc> places;
  for (const Keyframe& keyframe : keyframes_) places.push_back({keyframe.drawn, keyframe.hits.reach()});
  map->cover(places);
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    for (const Kept& kept : keyframes_[i].scans) {
      map->insert(scan_of(kept), keyframes_[i].drawn * kept.relative, static_cast<int>(i));
    }
  }
}

Scan Keyframes::lately() const {
  const Keyframe& last = keyframes_.back();
  Scan result;
  for (auto at = keyframes_.rbegin(); at != keyframes_.rend() && last.way.distance - at->way.distance <= kLately;
       ++at) {
    at->hits.append_to(&result, between(last.drawn, at->drawn));
  }
  return result;
}

std::vector<Scan> Keyframes::seen_lately(std::size_t keyframe) const {
  std::vector<Scan> scans;
  const double now = keyframes_.back().way.distance;
  for (auto at = keyframes_.rbegin(); at != keyframes_.rend() && now - at->way.distance <= kFarLately; ++at) {
    if (scans.size() == kMostLately) break;
    const Kept& kept = at->scans.front();
    scans.push_back(seen_from(between(keyframes_[keyframe].drawn, at->drawn * kept.relative), scan_of(kept)));
  }
  return scans;
}

GridMap Keyframes::drawn_around(const Pose& pose) const {
  std::vector<std::pair<double, int>> nearest;
  for (int i = 0; i <= long_ago_; ++i) {
    const double away = distance(keyframes_[i].drawn, pose);
    if (away <= kNearHere) nearest.emplace_back(away, i);
  }
  const auto end = nearest.begin() + std::min<long>(kMostAround, static_cast<long>(nearest.size()));
  std::partial_sort(nearest.begin(), end, nearest.end());
  std::sort(nearest.begin(), end, [](const auto& a, const auto& b) { return a.second < b.second; });
  GridMap map(grid_);
  std::vector<GridMap::Disc> places;
  for (auto at = nearest.begin(); at != end; ++at) {
    places.push_back({keyframes_[at->second].drawn, keyframes_[at->second].hits.reach()});
  }
  map.cover(places);
  for (auto at = nearest.begin(); at != end; ++at) {
    keyframes_[at->second].hits.draw(&map, keyframes_[at->second].drawn, at->second);
  }
  return map;
}

std::vector<Keyframes::Place> Keyframes::old_scans(const Pose& here, double within) const {
  std::vector<Place> scans;
  for (int i = 0; i <= long_ago_; ++i) {
    if (distance(keyframes_[i].drawn, here) > within) continue;
    for (std::size_t scan = 0; scan < keyframes_[i].scans.size(); scan += kEveryOldScan) scans.emplace_back(i, scan);
  }
  return scans;
}

}  // namespace mr_robot::slam
