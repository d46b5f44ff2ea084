#include "surfaces.hpp"

#include <utility>

namespace mr_robot::slam {

void Surfaces::resize(int columns, int rows, int right, int up) {
  std::vector<std::unique_ptr<Block>> moved(static_cast<std::size_t>(columns) * rows);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      moved[static_cast<std::size_t>(row + up) * columns + column + right] =
          std::move(blocks_[static_cast<std::size_t>(row) * columns_ + column]);
    }
  }
  blocks_ = std::move(moved);
  columns_ = columns;
  rows_ = rows;
}

Surface& Surfaces::at(int column, int row) {
  std::unique_ptr<Block>& block = blocks_[block_of(column, row)];
  if (!block) block = std::make_unique<Block>();
  return (*block)[within(column, row)];
}

}  // namespace mr_robot::slam
