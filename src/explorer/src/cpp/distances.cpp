#include "distances.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

namespace explorer {
namespace {

// Lengths of the moves of a pawn, a bishop and a knight in 1/65536 of a cell: 1, 1.4, 2.1969.
constexpr std::int32_t kStraight = 65536, kDiagonal = 91750, kKnight = 143976;
constexpr std::int32_t kFar = 1 << 30;
constexpr std::ptrdiff_t kBorder = 2;

float to_length(std::int32_t distance, float resolution) {
  return static_cast<float>(distance) * (1.0F / kStraight) * resolution;
}

// Lowers a row to what the row next to it and the one beyond, both done, make of it.
void spread_across(const std::int32_t* next, const std::int32_t* beyond, std::ptrdiff_t columns, std::int32_t* row) {
  for (std::ptrdiff_t c = 0; c < columns; ++c) {
    const std::int32_t knight =
        std::min(std::min(beyond[c - 1], beyond[c + 1]), std::min(next[c - 2], next[c + 2])) + kKnight;
    const std::int32_t diagonal = std::min(next[c - 1], next[c + 1]) + kDiagonal;
    row[c] = std::min(std::min(row[c], next[c] + kStraight), std::min(knight, diagonal));
  }
}

std::int32_t chamfer(std::int32_t down, std::int32_t right) {
  const auto [less, more] = std::minmax(down, right);
  if (more >= 2 * less) return less * kKnight + (more - 2 * less) * kStraight;
  return (more - less) * kKnight + (2 * less - more) * kDiagonal;
}

// Half widths of the rows of the disc of cells nearer than `reach`, from its middle on.
std::vector<std::ptrdiff_t> disc(float resolution, float reach) {
  std::vector<std::ptrdiff_t> widths;
  for (std::int32_t down = 0; to_length(chamfer(down, 0), resolution) < reach; ++down) {
    std::int32_t right = 0;
    while (to_length(chamfer(down, right + 1), resolution) < reach) ++right;
    widths.push_back(right);
  }
  return widths;
}

// Whether all cells within a move of those of a row are set, by columns; what lies outside of the grid counts as set.
// `above_and_below` is a buffer of columns + 2 * kBorder cells.
void find_inner(const Mask& mask, std::ptrdiff_t row, std::vector<std::uint8_t>& above_and_below,
                std::vector<std::uint8_t>& inner) {
  std::fill(above_and_below.begin(), above_and_below.end(), 1);
  std::uint8_t* all = above_and_below.data() + kBorder;
  const std::ptrdiff_t bottom = std::min(row + kBorder, mask.rows - 1);
  for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(row - kBorder, 0); r <= bottom; ++r) {
    const std::uint8_t* cells = mask.cells + r * mask.columns;
    for (std::ptrdiff_t c = 0; c < mask.columns; ++c) all[c] &= cells[c];
  }
  for (std::ptrdiff_t c = 0; c < mask.columns; ++c)
    inner[c] = all[c - 2] & all[c - 1] & all[c] & all[c + 1] & all[c + 2];
}

void mark_disc(const Mask& mask, const std::vector<std::ptrdiff_t>& widths, std::ptrdiff_t row, std::ptrdiff_t column,
               bool* near) {
  const auto reach = static_cast<std::ptrdiff_t>(widths.size()) - 1;
  for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(row - reach, 0); r <= std::min(row + reach, mask.rows - 1); ++r) {
    const std::ptrdiff_t width = widths[static_cast<std::size_t>(std::abs(r - row))];
    const std::ptrdiff_t left = std::max<std::ptrdiff_t>(column - width, 0);
    const std::ptrdiff_t right = std::min(column + width, mask.columns - 1);
    std::fill(near + r * mask.columns + left, near + r * mask.columns + right + 1, true);
  }
}

}  // namespace

void distances_to(const Mask& mask, float resolution, float* distances) {
  const std::ptrdiff_t stride = mask.columns + 2 * kBorder;
  std::vector<std::int32_t> lengths(static_cast<std::size_t>((mask.rows + 2 * kBorder) * stride), kFar);
  const auto row_of = [&](std::ptrdiff_t row) { return lengths.data() + (row + kBorder) * stride + kBorder; };
  for (std::ptrdiff_t r = 0; r < mask.rows; ++r) {
    std::int32_t* row = row_of(r);
    const std::uint8_t* cells = mask.cells + r * mask.columns;
    spread_across(row_of(r - 1), row_of(r - 2), mask.columns, row);
    std::int32_t left = kFar;
    for (std::ptrdiff_t c = 0; c < mask.columns; ++c) {
      left = cells[c] ? 0 : std::min(row[c], left + kStraight);
      row[c] = left;
    }
  }
  for (std::ptrdiff_t r = mask.rows - 1; r >= 0; --r) {
    std::int32_t* row = row_of(r);
    spread_across(row_of(r + 1), row_of(r + 2), mask.columns, row);
    std::int32_t right = kFar;
    for (std::ptrdiff_t c = mask.columns - 1; c >= 0; --c) row[c] = right = std::min(row[c], right + kStraight);
    for (std::ptrdiff_t c = 0; c < mask.columns; ++c) distances[r * mask.columns + c] = to_length(row[c], resolution);
  }
}

void cells_near(const Mask& mask, float resolution, float reach, bool* near) {
  std::copy_n(mask.cells, mask.rows * mask.columns, near);
  const std::vector<std::ptrdiff_t> widths = disc(resolution, reach);
  std::vector<std::uint8_t> buffer(static_cast<std::size_t>(mask.columns + 2 * kBorder));
  std::vector<std::uint8_t> inner(static_cast<std::size_t>(mask.columns));
  for (std::ptrdiff_t row = 0; row < mask.rows; ++row) {
    find_inner(mask, row, buffer, inner);
    const std::uint8_t* cells = mask.cells + row * mask.columns;
    for (std::ptrdiff_t column = 0; column < mask.columns; ++column) {
      // The discs around inner cells would add nothing.
      if (cells[column] > inner[column]) mark_disc(mask, widths, row, column, near);
    }
  }
}

}  // namespace explorer
