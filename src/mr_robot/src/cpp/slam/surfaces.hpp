// Surfaces of the cells of a map, in square blocks that take memory from their first surface on: most have none.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace mr_robot::slam {

// Mean of the hits in a cell.
struct Surface {
  float x = 0.0F, y = 0.0F;                // m, map frame
  float normal_x = 0.0F, normal_y = 0.0F;  // towards the side it was seen from
  float hits = 0.0F;                       // 0: no surface
  float scans = 0.0F;                      // in which it was hit: few for what moves
  int origin = 0;                          // what the first of these was inserted with
};

class Surfaces {
 public:
  static constexpr int kBlock = 32;  // cells along a side

  // To so many blocks, the ones there are moved by `right` and `up` blocks.
  void resize(int columns, int rows, int right, int up);
  // Whether the block of a cell, by its column and row, has memory.
  bool holds(int column, int row) const { return blocks_[block_of(column, row)] != nullptr; }
  // Of a cell for which that is so.
  const Surface& operator()(int column, int row) const {
    return (*blocks_[block_of(column, row)])[within(column, row)];
  }
  // Of any cell, whose block has memory from then on.
  Surface& at(int column, int row);

 private:
  using Block = std::array<Surface, kBlock * kBlock>;

  std::size_t block_of(int column, int row) const {
    return static_cast<std::size_t>(row / kBlock) * columns_ + column / kBlock;
  }
  static std::size_t within(int column, int row) { return row % kBlock * kBlock + column % kBlock; }

  std::vector<std::unique_ptr<Block>> blocks_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace mr_robot::slam
