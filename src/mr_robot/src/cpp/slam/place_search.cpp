#include "place_search.hpp"

#include <algorithm>

namespace mr_robot::slam {
namespace {

constexpr std::size_t kMostFeatures = 300;
constexpr double kLeastCounted = 0.5;   // of the features that lie on surfaces,
constexpr double kRivalCounted = 0.75;  // and of the best: what fits less well is no place
constexpr double kFar = 1.5;            // times their root mean square, the distance of features that is resolved
constexpr double kOnePlace = 0.6;       // m, and
constexpr double kOneHeading = 0.3;     // rad within which only the best is a place
constexpr std::size_t kPlacesKept = 32;
constexpr long kLooksAtOnce = 1'000'000;  // at cells, with each step,
constexpr long kMostLooks = 160'000'000;

}  // namespace

PlaceSearch::PlaceSearch(const SurfacePyramid& map, const std::vector<Feature>& features, const Pose& centre,
                         const Pose& window)
    : map_(map), centre_(centre) {
  // From all over, in any order: few of them tell most wrong places.
  const std::size_t size = features.size(), wanted = std::min(size, kMostFeatures);
  double squares = 1.0;
  for (std::size_t i = 0; i < wanted; ++i) {
    const double golden = std::fmod(0.6180339887498949 * static_cast<double>(i), 1.0);
    features_.push_back(features[static_cast<std::size_t>(golden * static_cast<double>(size))]);
    const Point& at = features_.back().at;
    squares += at.x * at.x + at.y * at.y;
  }
  const double far = kFar * std::sqrt(squares / static_cast<double>(std::max<std::size_t>(wanted, 1)));
  turn_step_ = map.cell() / std::max(far, 1.0);
  turns_ = static_cast<int>(std::ceil(std::min(window.yaw, M_PI) / turn_step_));
  const auto cells = [&](double from) { return static_cast<int>(std::floor(from / map.cell())); };
  low_x_ = std::max(cells(centre.x - window.x - map.corner().x), 0);
  low_y_ = std::max(cells(centre.y - window.y - map.corner().y), 0);
  high_x_ = std::min(cells(centre.x + window.x - map.corner().x), map.width() - 1);
  high_y_ = std::min(cells(centre.y + window.y - map.corner().y), map.height() - 1);
  best_ = 0;
}

int PlaceSearch::least() const {
  const auto size = static_cast<double>(features_.size());
  return static_cast<int>(std::ceil(std::max(kLeastCounted * size, kRivalCounted * best_)));
}

// The next heading, from the one that is expected to both sides. Returns whether there is one.
bool PlaceSearch::turn() {
  if (next_turn_ > 2 * turns_) return false;
  const int steps = (next_turn_ + 1) / 2 * (next_turn_ % 2 == 0 ? 1 : -1);
  ++next_turn_;
  heading_ = normalized(centre_.yaw + steps * turn_step_);
  const Frame frame({0.0, 0.0, heading_});
  hits_.clear();
  for (const Feature& feature : features_) {
    const Point at = frame * feature.at;
    hits_.push_back({static_cast<int>(std::lround(at.x / map_.cell())),
                     static_cast<int>(std::lround(at.y / map_.cell())), facing_of_hit(frame.turned(feature.normal))});
  }
  constexpr int kTop = SurfacePyramid::kLevels - 1;
  for (int row = low_y_; row <= high_y_; row += 1 << kTop) {
    for (int column = low_x_; column <= high_x_; column += 1 << kTop) {
      const int found = count(kTop, column, row);
      if (found >= least()) squares_.push_back({kTop, column, row, found});
    }
  }
  return true;
}

// Less than `least()` where there are so few, whatever the exact number.
int PlaceSearch::count(int level, int column, int row) {
  const int most_missed = static_cast<int>(hits_.size()) - least();
  int missed = 0;
  std::size_t looked = 0;
  for (; looked < hits_.size() && missed <= most_missed; ++looked) {
    const Hit& hit = hits_[looked];
    missed += (map_.facings(level, column + hit.column, row + hit.row) & hit.facing) == 0;
  }
  looked_ += static_cast<long>(looked);
  return static_cast<int>(hits_.size()) - missed;
}

void PlaceSearch::split(const Square& square) {
  const int level = square.level - 1, half = 1 << level;
  const std::size_t first = squares_.size();
  for (const int row : {square.row, square.row + half}) {
    for (const int column : {square.column, square.column + half}) {
      if (row > high_y_ || column > high_x_) continue;
      const int found = count(level, column, row);
      if (found >= least()) squares_.push_back({level, column, row, found});
    }
  }
  std::sort(squares_.begin() + static_cast<long>(first), squares_.end(),
            [](const Square& a, const Square& b) { return a.count < b.count; });
}

void PlaceSearch::keep(const Square& square) {
  const Point& corner = map_.corner();
  const Place place{
      {corner.x + (square.column + 0.5) * map_.cell(), corner.y + (square.row + 0.5) * map_.cell(), heading_},
      static_cast<double>(square.count) / static_cast<double>(features_.size())};
  best_ = std::max(best_, square.count);
  const auto same = [&](const Place& other) {
    return distance(other.pose, place.pose) < kOnePlace &&
           std::abs(normalized(other.pose.yaw - place.pose.yaw)) < kOneHeading;
  };
  if (std::any_of(places_.begin(), places_.end(),
                  [&](const Place& other) { return same(other) && other.share >= place.share; }))
    return;
  places_.erase(std::remove_if(places_.begin(), places_.end(), same), places_.end());
  places_.push_back(place);
  if (places_.size() <= kPlacesKept) return;
  places_.erase(std::min_element(places_.begin(), places_.end(),
                                 [](const Place& a, const Place& b) { return a.share < b.share; }));
}

bool PlaceSearch::step() {
  for (const long until = looked_ + kLooksAtOnce; looked_ < until;) {
    if (looked_ > kMostLooks) return true;
    if (squares_.empty()) {
      if (!turn()) return true;
      continue;
    }
    const Square square = squares_.back();
    squares_.pop_back();
    if (square.count < least()) continue;
    if (square.level == 0) {
      keep(square);
    } else {
      split(square);
    }
  }
  return false;
}

std::vector<PlaceSearch::Place> PlaceSearch::places() const {
  std::vector<Place> found;
  if (looked_ > kMostLooks) return found;
  for (const Place& place : places_) {
    if (place.share >= kRivalCounted * best_ / static_cast<double>(features_.size())) found.push_back(place);
  }
  std::sort(found.begin(), found.end(), [](const Place& a, const Place& b) { return a.share > b.share; });
  return found;
}

}  // namespace mr_robot::slam
