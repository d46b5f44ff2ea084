#include "views.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "lines.hpp"

namespace explorer {
namespace {

using mr_grid::Grid;
using mr_grid::Point;

template <typename Value>
std::int64_t row_of(const Grid<Value>& grid, double y) {
  return static_cast<std::int64_t>(std::floor((y - grid.origin.y) / grid.resolution));
}

template <typename Value>
std::int64_t column_of(const Grid<Value>& grid, double x) {
  return static_cast<std::int64_t>(std::floor((x - grid.origin.x) / grid.resolution));
}

template <typename Value>
std::int64_t index_of_nearest(const Grid<Value>& grid, const Point& point) {
  const std::int64_t row = std::clamp<std::int64_t>(row_of(grid, point.y), 0, grid.rows - 1);
  const std::int64_t column = std::clamp<std::int64_t>(column_of(grid, point.x), 0, grid.columns - 1);
  return grid.index(row, column);
}

template <typename Value>
Point centre_of(const Grid<Value>& grid, std::int64_t index) {
  return grid.middle_of(index / grid.columns, index % grid.columns);
}

// Writes to `clear` which of n pairs of cells see each other, group by group.
void look(const Grid<std::uint8_t>& blocked, const std::vector<std::int64_t>& starts,
          const std::vector<std::int64_t>& ends, const std::int64_t* groups, std::size_t n, bool* clear) {
  for (std::size_t first = 0, next = 0; first < n; first = next) {
    while (next < n && groups[next] == groups[first]) ++next;
    lines_are_clear(blocked, &starts[2 * first], &ends[2 * first], next - first, clear + first);
  }
}

struct Candidate {
  double gap;
  std::int64_t cell;
};

// Every third of the reachable cells around a point, from near to far, by rows where they are as near.
std::vector<std::int64_t> cells_around(const Grid<std::uint8_t>& reachable, const Point& point, double view_distance) {
  const std::int64_t row = row_of(reachable, point.y), column = column_of(reachable, point.x);
  const auto reach = static_cast<std::int64_t>(view_distance / reachable.resolution);
  std::vector<Candidate> found;
  const std::int64_t bottom = std::min<std::int64_t>(row + reach, reachable.rows - 1);
  const std::int64_t right = std::min<std::int64_t>(column + reach, reachable.columns - 1);
  for (std::int64_t r = std::max<std::int64_t>(row - reach, 0); r <= bottom; ++r) {
    for (std::int64_t c = std::max<std::int64_t>(column - reach, 0); c <= right; ++c) {
      if (!reachable.at(r, c)) continue;
      const double gap = std::hypot(static_cast<double>(r - row), static_cast<double>(c - column));
      found.push_back({gap, reachable.index(r, c)});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) { return a.gap < b.gap; });
  std::vector<std::int64_t> cells;
  for (std::size_t i = 0; i < found.size(); i += 3) cells.push_back(found[i].cell);
  return cells;
}

std::int64_t search(const Grid<std::uint8_t>& reachable, const Grid<std::uint8_t>& blocked, const Point& point,
                    double view_distance) {
  const std::vector<std::int64_t> cells = cells_around(reachable, point, view_distance);
  std::vector<std::int64_t> starts, ends;
  for (const std::int64_t cell : cells) {
    const Point place = centre_of(reachable, cell);
    starts.insert(starts.end(), {row_of(blocked, place.y), column_of(blocked, place.x)});
    ends.insert(ends.end(), {row_of(blocked, point.y), column_of(blocked, point.x)});
  }
  const std::int64_t samples = longest_line(starts.data(), ends.data(), cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Point place = centre_of(reachable, cells[i]);
    if (std::hypot(place.x - point.x, place.y - point.y) > view_distance) continue;
    if (line_is_clear(blocked, &starts[2 * i], &ends[2 * i], samples)) return cells[i];
  }
  return -1;
}

}  // namespace

void search_views(const Grid<std::uint8_t>& reachable, const Grid<std::uint8_t>& blocked, const double* points,
                  std::size_t n, double view_distance, std::int64_t* views) {
  for (std::size_t i = 0; i < n; ++i) {
    views[i] = search(reachable, blocked, {points[2 * i], points[2 * i + 1]}, view_distance);
  }
}

void nearest_views(const Grid<std::int32_t>& labels, const std::int64_t* places, const Grid<std::uint8_t>& blocked,
                   const double* points, const std::int64_t* groups, std::size_t n, double view_distance,
                   std::int64_t* views) {
  std::vector<std::int64_t> starts, ends;
  for (std::size_t i = 0; i < n; ++i) {
    const Point point{points[2 * i], points[2 * i + 1]};
    views[i] = places[labels.values[index_of_nearest(labels, point)] - 1];
    const Point place = centre_of(labels, views[i]);
    starts.insert(starts.end(), {row_of(blocked, place.y), column_of(blocked, place.x)});
    ends.insert(ends.end(), {row_of(blocked, point.y), column_of(blocked, point.x)});
  }
  const auto clear = std::make_unique<bool[]>(n);
  look(blocked, starts, ends, groups, n, clear.get());
  for (std::size_t i = 0; i < n; ++i) {
    const Point place = centre_of(labels, views[i]);
    const double gap = std::hypot(place.x - points[2 * i], place.y - points[2 * i + 1]);
    if (!clear[i] || gap > view_distance) views[i] = -1;
  }
}

}  // namespace explorer
