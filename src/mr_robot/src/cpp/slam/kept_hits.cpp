#include "kept_hits.hpp"

#include <algorithm>

namespace mr_robot::slam {
namespace {

constexpr std::size_t kEveryScan = 3;

}  // namespace

void KeptHits::add(const Scan& scan, const Pose& pose) {
  if (seen_++ % kEveryScan != 0) return;
  const Frame frame(pose);
  Hits& hits = scans_.emplace_back();
  for (const Beam* beam : spaced_hits(scan)) {
    const Point end = frame * beam->end, normal = frame.turned(beam->normal);
    hits.push_back({static_cast<float>(end.x), static_cast<float>(end.y), static_cast<float>(normal.x),
                    static_cast<float>(normal.y)});
    reach_ = std::max(reach_, length_of(end.x, end.y));
  }
}

void KeptHits::append(const Hits& hits, const Pose& place, Scan* scan) {
  const Frame frame(place);
  for (const Hit& hit : hits) {
    Beam beam{frame * Point{hit.x, hit.y}, true};
    beam.has_normal = true;
    beam.normal = frame.turned({hit.normal_x, hit.normal_y});
    beam.spacing = kHitSpacing;
    scan->beams.push_back(beam);
  }
}

void KeptHits::append_to(Scan* scan, const Pose& place) const {
  for (const Hits& hits : scans_) append(hits, place, scan);
}

// Scan by scan, for surfaces count those in which they were hit.
void KeptHits::draw(GridMap* map, const Pose& place, int origin) const {
  for (const Hits& hits : scans_) {
    Scan scan;
    append(hits, Pose{}, &scan);
    map->add_hits(scan, place, origin);
  }
}

}  // namespace mr_robot::slam
