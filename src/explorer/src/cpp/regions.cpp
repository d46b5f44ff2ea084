#include "regions.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "disjoint_sets.hpp"

namespace explorer {
namespace {

// Cells of one row that are set side by side, as indices of the grid.
struct Run {
  std::ptrdiff_t begin, end;
};

// Where the next cell with this value is between two indices, or the end.
std::ptrdiff_t find(const std::uint8_t* cells, std::ptrdiff_t from, std::ptrdiff_t end, int value) {
  const void* found = std::memchr(cells + from, value, static_cast<std::size_t>(end - from));
  return found == nullptr ? end : static_cast<const std::uint8_t*>(found) - cells;
}

// The runs of all rows, and for each row, and behind the last one, the number of its first run.
struct Runs {
  std::vector<Run> all;
  std::vector<std::size_t> first;
};

Runs find_runs(const std::uint8_t* cells, std::ptrdiff_t rows, std::ptrdiff_t columns) {
  Runs runs;
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    runs.first.push_back(runs.all.size());
    const std::ptrdiff_t end = (row + 1) * columns;
    std::ptrdiff_t begin = find(cells, row * columns, end, 1);
    while (begin < end) {
      const std::ptrdiff_t stop = find(cells, begin, end, 0);
      runs.all.push_back({begin, stop});
      begin = find(cells, stop, end, 1);
    }
  }
  runs.first.push_back(runs.all.size());
  return runs;
}

// Joins the runs of each row with those of the row above that touch them, at corners too.
DisjointSets joined(const Runs& runs, std::ptrdiff_t columns) {
  DisjointSets sets(runs.all.size());
  for (std::size_t row = 1; row + 1 < runs.first.size(); ++row) {
    std::size_t above = runs.first[row - 1], here = runs.first[row];
    while (above < runs.first[row] && here < runs.first[row + 1]) {
      const Run upper{runs.all[above].begin + columns, runs.all[above].end + columns}, lower = runs.all[here];
      if (upper.begin <= lower.end && lower.begin <= upper.end) sets.join(above, here);
      if (upper.end < lower.end)
        ++above;
      else
        ++here;
    }
  }
  return sets;
}

}  // namespace

void connected_part(const std::uint8_t* cells, std::ptrdiff_t rows, std::ptrdiff_t columns, std::ptrdiff_t start,
                    bool* part) {
  std::fill_n(part, rows * columns, false);
  if (!cells[start]) return;
  const Runs runs = find_runs(cells, rows, columns);
  DisjointSets sets = joined(runs, columns);
  const auto behind = std::upper_bound(runs.all.begin(), runs.all.end(), start,
                                       [](std::ptrdiff_t index, const Run& run) { return index < run.begin; });
  const std::size_t wanted = sets.find(static_cast<std::size_t>(behind - runs.all.begin()) - 1);
  for (std::size_t i = 0; i < runs.all.size(); ++i) {
    if (sets.find(i) == wanted) std::fill(part + runs.all[i].begin, part + runs.all[i].end, true);
  }
}

void cells_within(const std::uint8_t* cells, std::ptrdiff_t rows, std::ptrdiff_t columns, const std::int64_t* seeds,
                  std::size_t n, int steps, bool* near) {
  std::fill_n(near, rows * columns, false);
  std::vector<std::ptrdiff_t> edge, next;
  const auto take = [&](std::ptrdiff_t index) {
    if (!cells[index] || near[index]) return;
    near[index] = true;
    next.push_back(index);
  };
  for (std::size_t i = 0; i < n; ++i) take(seeds[i]);
  for (int step = 0; step < steps && !next.empty(); ++step) {
    edge.clear();
    edge.swap(next);
    for (const std::ptrdiff_t index : edge) {
      const std::ptrdiff_t row = index / columns, column = index % columns;
      for (std::ptrdiff_t y = std::max<std::ptrdiff_t>(row - 1, 0); y <= std::min(row + 1, rows - 1); ++y) {
        for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(column - 1, 0); x <= std::min(column + 1, columns - 1); ++x) {
          take(y * columns + x);
        }
      }
    }
  }
}

}  // namespace explorer
