#include "frontier_cells.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "disjoint_sets.hpp"

namespace explorer {
namespace {

constexpr std::ptrdiff_t kGap = 3;  // cells

// Tells unknown cells of islands from others without ever looking at more cells of the others than needed.
class Islands {
 public:
  Islands(const OccupancyGrid& map, std::size_t smallest)
      : cells_(map.cells), smallest_(smallest), verdicts_(map.cells.count(), kOpen) {}

  bool is_large(std::ptrdiff_t index) {
    if (verdicts_[index] == kOpen) judge(index);
    return verdicts_[index] == kLarge;
  }

 private:
  enum Verdict : std::uint8_t { kOpen, kVisited, kSmall, kLarge };

  void judge(std::ptrdiff_t start) {
    visited_.assign(1, start);
    verdicts_[start] = kVisited;
    bool large = false;
    for (std::size_t next = 0; next < visited_.size() && !large; ++next) large = spread(visited_[next]);
    for (const std::ptrdiff_t index : visited_) verdicts_[index] = large ? kLarge : kSmall;
  }

  // True if the area is known to be large now.
  bool spread(std::ptrdiff_t index) {
    const std::ptrdiff_t column = index % cells_.columns, row = index / cells_.columns;
    return visited_.size() >= smallest_ || (row > 0 && visit(index - cells_.columns)) ||
           (row + 1 < cells_.rows && visit(index + cells_.columns)) || (column > 0 && visit(index - 1)) ||
           (column + 1 < cells_.columns && visit(index + 1));
  }

  bool visit(std::ptrdiff_t index) {
    if (cells_.values[index] >= 0 || verdicts_[index] == kVisited) return false;
    if (verdicts_[index] == kLarge) return true;
    verdicts_[index] = kVisited;
    visited_.push_back(index);
    return visited_.size() >= smallest_;
  }

  const mr_grid::Cells<std::int8_t>& cells_;
  std::size_t smallest_;
  std::vector<std::uint8_t> verdicts_;
  std::vector<std::ptrdiff_t> visited_;
};

bool is_frontier(const OccupancyGrid& map, int row, int column, Islands& islands) {
  bool near_unknown = false;
  const auto& cells = map.cells;
  const int bottom = std::min(row + 1, cells.rows - 1), right = std::min(column + 1, cells.columns - 1);
  for (int r = std::max(row - 1, 0); r <= bottom; ++r) {
    for (int c = std::max(column - 1, 0); c <= right; ++c) {
      const std::int8_t value = cells.at(r, c);
      if (value >= map.occupied_from) return false;
      if (value < 0 && !near_unknown) near_unknown = islands.is_large(cells.index(r, c));
    }
  }
  return near_unknown;
}

// Of a row and the ones around it, which columns hold an unknown cell: most cells need no closer look.
void columns_near_unknown(const mr_grid::Cells<std::int8_t>& cells, int row, std::vector<std::int8_t>& least) {
  std::copy_n(&cells.at(row, 0), cells.columns, least.begin() + 1);
  for (const int other : {row - 1, row + 1}) {
    if (other < 0 || other >= cells.rows) continue;
    const std::int8_t* values = &cells.at(other, 0);
    for (int column = 0; column < cells.columns; ++column) {
      least[column + 1] = std::min(least[column + 1], values[column]);
    }
  }
}

std::vector<std::int64_t> find_frontiers(const OccupancyGrid& map, std::size_t smallest_unknown) {
  Islands islands(map, smallest_unknown);
  std::vector<std::int64_t> found;
  const auto& cells = map.cells;
  std::vector<std::int8_t> least(static_cast<std::size_t>(cells.columns) + 2, 0);
  for (int row = 0; row < cells.rows; ++row) {
    columns_near_unknown(cells, row, least);
    for (int column = 0; column < cells.columns; ++column) {
      if ((least[column] & 0x80) == 0 && (least[column + 1] & 0x80) == 0 && (least[column + 2] & 0x80) == 0) continue;
      const std::int8_t value = cells.at(row, column);
      if (value < 0 || value >= map.free_below || !is_frontier(map, row, column, islands)) continue;
      found.push_back(cells.index(row, column));
    }
  }
  return found;
}

// Joins each of the cells, ascending indices, with those before it that are no more than `kGap` away.
DisjointSets joined(const std::int64_t* cells, std::size_t n, std::ptrdiff_t columns) {
  DisjointSets sets(n);
  std::array<std::size_t, kGap + 1> nearest{};  // for each row above the first cell that may be near enough
  for (std::size_t number = 0; number < n; ++number) {
    const std::ptrdiff_t row = cells[number] / columns, column = cells[number] % columns;
    const std::ptrdiff_t left = std::max<std::ptrdiff_t>(column - kGap, 0);
    const std::ptrdiff_t right = std::min(column + kGap, columns - 1);
    for (std::ptrdiff_t up = 0; up <= std::min(kGap, row); ++up) {
      std::size_t& other = nearest[static_cast<std::size_t>(up)];
      const std::ptrdiff_t begin = (row - up) * columns;
      while (cells[other] < begin + left) ++other;
      for (std::size_t i = other; i < number && cells[i] <= begin + right; ++i) sets.join(number, i);
    }
  }
  return sets;
}

}  // namespace

void large_frontiers(const std::int64_t* cells, std::size_t n, std::ptrdiff_t columns, std::size_t smallest,
                     bool* large) {
  DisjointSets sets = joined(cells, n, columns);
  std::vector<std::size_t> sizes(n, 0);
  for (std::size_t number = 0; number < n; ++number) ++sizes[sets.find(number)];
  for (std::size_t number = 0; number < n; ++number) large[number] = sizes[sets.find(number)] >= smallest;
}

void frontier_cells(const OccupancyGrid& map, std::size_t smallest_unknown, std::size_t smallest_frontier,
                    bool* frontier) {
  std::fill_n(frontier, map.cells.count(), false);
  const std::vector<std::int64_t> cells = find_frontiers(map, smallest_unknown);
  const auto large = std::make_unique<bool[]>(cells.size());
  large_frontiers(cells.data(), cells.size(), map.cells.columns, smallest_frontier, large.get());
  for (std::size_t number = 0; number < cells.size(); ++number) frontier[cells[number]] = large[number];
}

}  // namespace explorer
