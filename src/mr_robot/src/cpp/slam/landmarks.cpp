#include "landmarks.hpp"

#include <cmath>
#include <map>

namespace mr_robot::slam {
namespace {

constexpr double kReach = 0.15;  // m within which edges are the same
constexpr long kAround = 2;      // squares of that size within which they lie, from one side of a wall to the other

struct Group {
  Edge mean;  // map frame
  Landmark landmark;
};

// Groups by the square of `kReach` in which they lie.
class Groups {
 public:
  Group& of(const Edge& edge) {
    const auto [column, row] = square_of(edge.place);
    for (long x = column - kAround; x <= column + kAround; ++x) {
      for (long y = row - kAround; y <= row + kAround; ++y) {
        const auto found = squares_.find({x, y});
        if (found == squares_.end()) continue;
        for (const std::size_t index : found->second) {
          if (same_end(groups_[index].mean, edge, kReach)) return groups_[index];
        }
      }
    }
    squares_[{column, row}].push_back(groups_.size());
    groups_.push_back({edge, {edge.off}});
    return groups_.back();
  }

  std::vector<Group>& all() { return groups_; }

 private:
  static std::pair<long, long> square_of(const Point& place) {
    return {std::lround(place.x / kReach), std::lround(place.y / kReach)};
  }

  std::map<std::pair<long, long>, std::vector<std::size_t>> squares_;
  std::vector<Group> groups_;
};

}  // namespace

std::vector<Landmark> landmarks_of(const std::vector<std::pair<std::size_t, Edge>>& edges,
                                   const std::vector<Pose>& poses) {
  Groups groups;
  for (const auto& [pose, edge] : edges) {
    const Edge there = Frame(poses[pose]) * edge;
    Landmark& landmark = groups.of(there).landmark;
    landmark.seen.emplace_back(pose, edge);
    const double coordinate = landmark.off.x * there.place.x + landmark.off.y * there.place.y;
    landmark.coordinate += (coordinate - landmark.coordinate) / static_cast<double>(landmark.seen.size());
  }
  std::vector<Landmark> landmarks;
  for (Group& group : groups.all()) {
    if (group.landmark.seen.size() > 1) landmarks.push_back(std::move(group.landmark));
  }
  return landmarks;
}

}  // namespace mr_robot::slam
