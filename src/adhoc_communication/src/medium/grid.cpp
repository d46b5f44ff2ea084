#include "medium/grid.hpp"

#include <algorithm>
#include <cmath>

namespace adhoc_communication {
namespace {

constexpr double kNarrowest = 0.01;  // metres
constexpr double kMargin = 1.001;    // so that rounding never puts a neighbour two squares away
constexpr double kFarthest = 1e15;   // squares

}  // namespace

NeighborGrid::NeighborGrid(double reach) : width_(std::max(reach, kNarrowest) * kMargin) {}

std::size_t NeighborGrid::Hash::operator()(const Square& square) const {
  return static_cast<std::size_t>(square.first) * 0x9e3779b97f4a7c15u + static_cast<std::size_t>(square.second);
}

NeighborGrid::Square NeighborGrid::square_of(const Position& position) const {
  const auto index = [this](double coordinate) {
    return static_cast<std::int64_t>(std::clamp(std::floor(coordinate / width_), -kFarthest, kFarthest));
  };
  return {index(position.x), index(position.y)};
}

void NeighborGrid::insert(std::size_t node, const Position& position) { squares_[square_of(position)].push_back(node); }

void NeighborGrid::remove(std::size_t node, const Position& position) {
  const auto square = squares_.find(square_of(position));
  if (square == squares_.end()) return;
  auto& nodes = square->second;
  nodes.erase(std::remove(nodes.begin(), nodes.end(), node), nodes.end());
  if (nodes.empty()) squares_.erase(square);
}

void NeighborGrid::near(const Position& position, std::vector<std::size_t>& nodes) const {
  const auto [column, row] = square_of(position);
  for (const std::int64_t right : {-1, 0, 1}) {
    for (const std::int64_t up : {-1, 0, 1}) {
      const auto square = squares_.find({column + right, row + up});
      if (square != squares_.end()) nodes.insert(nodes.end(), square->second.begin(), square->second.end());
    }
  }
}

}  // namespace adhoc_communication
