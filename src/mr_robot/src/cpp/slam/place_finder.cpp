#include "place_finder.hpp"

#include <algorithm>

namespace mr_robot::slam {
namespace {

constexpr std::size_t kKeptHits = 60;       // of a scan
constexpr std::size_t kMostPlaces = 24;     // that look alike at first sight, to be looked at closely
constexpr double kLeastOn = 0.5;            // of all hits that must lie on surfaces, and
constexpr double kLeastShare = 0.85;        // of those in known parts
constexpr double kRivalOn = 0.75;           // of the best: elsewhere as good, and
constexpr double kRivalShare = 0.1;         // less of those in known parts
constexpr double kElsewhereDistance = 0.4;  // m, or
constexpr double kElsewhereAngle = 0.1;     // rad from which on it is elsewhere

// Of all hits, those on surfaces.
double on(const Match& match) { return match.share * match.known; }

}  // namespace

bool fits_well(const Match& match) { return on(match) >= kLeastOn && match.share >= kLeastShare; }

Scan seen_from(const Pose& place, const Scan& scan) {
  const Frame frame(place);
  const std::vector<const Beam*> hits = spaced_hits(scan);
  const std::size_t stride = std::max<std::size_t>(1, (hits.size() + kKeptHits - 1) / kKeptHits);
  Scan seen{frame * scan.eye, {}};
  for (std::size_t i = 0; i < hits.size(); i += stride) {
    Beam beam = *hits[i];
    beam.end = frame * beam.end;
    beam.normal = frame.turned(beam.normal);
    seen.beams.push_back(beam);
  }
  return seen;
}

bool PlaceFinder::prepare(const GridMap& map) {
  if (!pyramid_) pyramid_ = std::make_unique<SurfacePyramid>(map);
  if (!ready_) ready_ = pyramid_->grow(map);
  return ready_;
}

void PlaceFinder::begin(const std::vector<Feature>& features, const Pose& centre, const Pose& window) {
  forget();
  search_ = std::make_unique<PlaceSearch>(*pyramid_, features, centre, window);
}

void PlaceFinder::forget() {
  search_.reset();
  places_.clear();
  fits_.clear();
  said_.reset();
}

void PlaceFinder::map_changed() {
  forget();
  pyramid_.reset();
  ready_ = false;
}

std::optional<Match> PlaceFinder::step(const GridMap& map, const std::vector<Scan>& scans) {
  if (search_) {
    if (!search_->step()) return std::nullopt;
    for (const PlaceSearch::Place& place : search_->places()) places_.push_back(place.pose);
    if (places_.size() > kMostPlaces) places_.clear();
    search_.reset();
  } else if (fits_.size() < places_.size()) {
    fits_.push_back(match_place(map, scans, places_[fits_.size()], options_));
    if (fits_.size() == places_.size()) return judge();
  }
  return std::nullopt;
}

// Of the places that look alike: the one where it is, if no other is as good.
std::optional<Match> PlaceFinder::judge() {
  const auto best = std::max_element(fits_.begin(), fits_.end(),
                                     [](const Match& a, const Match& b) { return on(a) * a.share < on(b) * b.share; });
  const Match found = *best;
  const auto rivals = [&](const Match& other) {
    return apart(other.pose, found.pose, kElsewhereDistance, kElsewhereAngle) && on(other) >= kRivalOn * on(found) &&
           other.share >= found.share - kRivalShare;
  };
  if (fits_well(found) && tells_place(found) && std::none_of(fits_.begin(), fits_.end(), rivals)) return found;
  forget();
  return std::nullopt;
}

}  // namespace mr_robot::slam
