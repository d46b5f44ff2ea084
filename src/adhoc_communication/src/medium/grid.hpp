// Which robots are near a place, without looking at all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "propagation/position.hpp"

namespace adhoc_communication {

/// Squares as wide as the largest distance that counts: whoever is near is in the same square or one beside it.
class NeighborGrid {
 public:
  explicit NeighborGrid(double reach);

  void insert(std::size_t node, const Position& position);
  void remove(std::size_t node, const Position& position);
  /// Appends every node within reach of the position, and some farther ones, in no particular order.
  void near(const Position& position, std::vector<std::size_t>& nodes) const;

 private:
  using Square = std::pair<std::int64_t, std::int64_t>;
  struct Hash {
    std::size_t operator()(const Square& square) const;
  };
  Square square_of(const Position& position) const;

  double width_;
  std::unordered_map<Square, std::vector<std::size_t>, Hash> squares_;
};

}  // namespace adhoc_communication
