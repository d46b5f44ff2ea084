// Python module explorer._kernels.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <vector>

#include "changes.hpp"
#include "distances.hpp"
#include "frontier_cells.hpp"
#include "lines.hpp"
#include "points.hpp"
#include "pooling.hpp"
#include "regions.hpp"
#include "unknown.hpp"
#include "views.hpp"
#include "weighted_grid.hpp"

namespace py = pybind11;
using namespace explorer;

namespace {

template <typename Value>
using Array = py::array_t<Value, py::array::c_style | py::array::forcecast>;

void require(bool condition, const char* text) {
  if (!condition) throw std::invalid_argument(text);
}

WeightedGrid make_grid(const Array<float>& weights, double resolution) {
  require(weights.ndim() == 2, "weights need the shape (rows, columns)");
  const int rows = static_cast<int>(weights.shape(0)), columns = static_cast<int>(weights.shape(1));
  return WeightedGrid(weights.data(), rows, columns, resolution);
}

Array<double> costs_from(const WeightedGrid& grid, int row, int column) {
  Array<double> costs({grid.rows(), grid.columns()});
  grid.costs_from({row, column}, costs.mutable_data());
  return costs;
}

Array<double> costs_between(const WeightedGrid& grid, const std::vector<Cell>& cells) {
  const std::vector<double> costs = grid.costs_between(cells);
  Array<double> result({cells.size(), cells.size()});
  std::copy(costs.begin(), costs.end(), result.mutable_data());
  return result;
}

std::vector<Cell> path_to(const WeightedGrid& grid, int row, int column, const Array<double>& costs) {
  require(costs.ndim() == 2 && costs.shape(0) == grid.rows() && costs.shape(1) == grid.columns(),
          "costs need the shape of the grid");
  return grid.path_to({row, column}, costs.data());
}

bool is_inside(py::ssize_t row, py::ssize_t column, const py::array& grid) {
  return row >= 0 && column >= 0 && row < grid.shape(0) && column < grid.shape(1);
}

template <typename Value>
mr_grid::Cells<Value> to_cells(const Array<Value>& cells) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  return {cells.data(), static_cast<int>(cells.shape(0)), static_cast<int>(cells.shape(1))};
}

mr_grid::Cells<std::uint8_t> to_cells(const Array<bool>& cells) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  return {reinterpret_cast<const std::uint8_t*>(cells.data()), static_cast<int>(cells.shape(0)),
          static_cast<int>(cells.shape(1))};
}

bool are_pairs(const py::array& array) { return array.ndim() == 2 && array.shape(1) == 2; }

Array<bool> clear_lines(const Array<bool>& blocked, const Array<std::int64_t>& starts,
                        const Array<std::int64_t>& ends) {
  require(blocked.ndim() == 2, "blocked needs the shape (rows, columns)");
  require(are_pairs(starts) && are_pairs(ends) && starts.shape(0) == ends.shape(0), "lines need shapes (n, 2)");
  Array<bool> clear(starts.shape(0));
  lines_are_clear(to_cells(blocked), starts.data(), ends.data(), static_cast<std::size_t>(starts.shape(0)),
                  clear.mutable_data());
  return clear;
}

Array<float> pool(const Array<float>& values, const Array<bool>& mask, int factor) {
  require(values.ndim() == 2 && mask.ndim() == 2 && values.shape(0) == mask.shape(0) &&
              values.shape(1) == mask.shape(1) && factor > 0,
          "values and mask need the same shape (rows, columns)");
  const py::ssize_t rows = values.shape(0), columns = values.shape(1);
  Array<float> result({(rows + factor - 1) / factor, (columns + factor - 1) / factor});
  const auto* chosen = reinterpret_cast<const std::uint8_t*>(mask.data());
  pooled_maximum(values.data(), chosen, rows, columns, factor, result.mutable_data());
  return result;
}

Array<bool> find_frontier_cells(const Array<std::int8_t>& cells, int free_below, int occupied_from,
                                std::size_t smallest_unknown, std::size_t smallest_frontier) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  const OccupancyGrid map{to_cells(cells), static_cast<std::int8_t>(free_below),
                          static_cast<std::int8_t>(occupied_from)};
  Array<bool> frontier({map.cells.rows, map.cells.columns});
  frontier_cells(map, smallest_unknown, smallest_frontier, frontier.mutable_data());
  return frontier;
}

Array<bool> find_large_frontiers(const Array<std::int64_t>& cells, py::ssize_t columns, std::size_t smallest) {
  require(cells.ndim() == 1 && columns > 0, "cells need the shape (n,), columns must be positive");
  const auto n = static_cast<std::size_t>(cells.shape(0));
  require(std::is_sorted(cells.data(), cells.data() + n), "cells must ascend");
  Array<bool> large(cells.shape(0));
  large_frontiers(cells.data(), n, columns, smallest, large.mutable_data());
  return large;
}

Array<bool> find_changed_tiles(const Array<std::int8_t>& before, const Array<std::int8_t>& after, py::ssize_t edge) {
  require(before.ndim() == 2 && after.ndim() == 2 && before.shape(0) == after.shape(0) &&
              before.shape(1) == after.shape(1) && edge > 0,
          "before and after need the same shape (rows, columns)");
  const py::ssize_t rows = before.shape(0), columns = before.shape(1);
  Array<bool> changed({(rows + edge - 1) / edge, (columns + edge - 1) / edge});
  changed_tiles(before.data(), after.data(), rows, columns, edge, changed.mutable_data());
  return changed;
}

Array<bool> points_near_any(const Array<double>& points, const Array<double>& places, double distance) {
  require(are_pairs(points) && are_pairs(places), "points and places need shapes (n, 2)");
  Array<bool> near(points.shape(0));
  near_any(points.data(), static_cast<std::size_t>(points.shape(0)), places.data(),
           static_cast<std::size_t>(places.shape(0)), distance, near.mutable_data());
  return near;
}

Array<bool> points_within_any(const Array<double>& points, const Array<double>& places, double distance) {
  require(are_pairs(points) && are_pairs(places), "points and places need shapes (n, 2)");
  Array<bool> within(points.shape(0));
  within_any(points.data(), static_cast<std::size_t>(points.shape(0)), places.data(),
             static_cast<std::size_t>(places.shape(0)), distance, within.mutable_data());
  return within;
}

Array<std::int64_t> nearest_near_places(const Array<double>& points, const Array<double>& places, double distance) {
  require(are_pairs(points) && are_pairs(places), "points and places need shapes (n, 2)");
  Array<std::int64_t> nearest(points.shape(0));
  nearest_near(points.data(), static_cast<std::size_t>(points.shape(0)), places.data(),
               static_cast<std::size_t>(places.shape(0)), distance, nearest.mutable_data());
  return nearest;
}

Array<std::int64_t> thinned(const Array<double>& points, double distance) {
  require(are_pairs(points), "points need the shape (n, 2)");
  const auto kept = thin(points.data(), static_cast<std::size_t>(points.shape(0)), distance);
  Array<std::int64_t> result(static_cast<py::ssize_t>(kept.size()));
  std::copy(kept.begin(), kept.end(), result.mutable_data());
  return result;
}

py::tuple find_unknown_behind(const Array<std::int8_t>& cells, int occupied_from, const Array<bool>& enterable,
                              const Array<std::int64_t>& starts, int reach, int skipped) {
  require(cells.ndim() == 2 && enterable.ndim() == 2 && cells.shape(0) == enterable.shape(0) &&
              cells.shape(1) == enterable.shape(1),
          "cells and enterable need the same shape (rows, columns)");
  require(are_pairs(starts), "starts need the shape (n, 2)");
  const SightMap map{to_cells(cells), reinterpret_cast<const std::uint8_t*>(enterable.data()),
                     static_cast<std::int8_t>(occupied_from)};
  Array<double> areas({starts.shape(0), static_cast<py::ssize_t>(2)}), depths(starts.shape(0));
  unknown_behind(map, starts.data(), static_cast<std::size_t>(starts.shape(0)), reach, skipped, areas.mutable_data(),
                 depths.mutable_data());
  return py::make_tuple(areas, depths);
}

using Placement = std::tuple<double, double, double>;  // resolution, origin_x, origin_y

template <typename Value>
auto to_grid(const Placement& placement, const Array<Value>& values) {
  const auto cells = to_cells(values);
  using Kept = std::remove_const_t<std::remove_pointer_t<decltype(cells.values)>>;
  return mr_grid::Grid<Kept>{cells, std::get<0>(placement), {std::get<1>(placement), std::get<2>(placement)}};
}

Array<std::int64_t> find_views(const Placement& coarse, const Array<std::int32_t>& labels,
                               const Array<std::int64_t>& places, const Placement& fine, const Array<bool>& blocked,
                               const Array<double>& points, const Array<std::int64_t>& groups, double view_distance) {
  require(are_pairs(points) && groups.ndim() == 1 && groups.shape(0) == points.shape(0),
          "points need the shape (n, 2), groups (n,)");
  Array<std::int64_t> views(points.shape(0));
  nearest_views(to_grid(coarse, labels), places.data(), to_grid(fine, blocked), points.data(), groups.data(),
                static_cast<std::size_t>(points.shape(0)), view_distance, views.mutable_data());
  return views;
}

Array<std::int64_t> find_views_around(const Placement& coarse, const Array<bool>& reachable, const Placement& fine,
                                      const Array<bool>& blocked, const Array<double>& points, double view_distance) {
  require(are_pairs(points), "points need the shape (n, 2)");
  Array<std::int64_t> views(points.shape(0));
  search_views(to_grid(coarse, reachable), to_grid(fine, blocked), points.data(),
               static_cast<std::size_t>(points.shape(0)), view_distance, views.mutable_data());
  return views;
}

Array<std::int64_t> number_components(std::size_t count, const Array<std::int64_t>& edges) {
  require(are_pairs(edges), "edges need the shape (m, 2)");
  const auto numbers = components(count, edges.data(), static_cast<std::size_t>(edges.shape(0)));
  Array<std::int64_t> result(static_cast<py::ssize_t>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), result.mutable_data());
  return result;
}

Mask to_mask(const Array<bool>& cells) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  return {reinterpret_cast<const std::uint8_t*>(cells.data()), cells.shape(0), cells.shape(1)};
}

Array<float> distances(const Array<bool>& cells, float resolution) {
  const Mask mask = to_mask(cells);
  Array<float> result({mask.rows, mask.columns});
  distances_to(mask, resolution, result.mutable_data());
  return result;
}

Array<bool> near_cells(const Array<bool>& cells, float resolution, float reach) {
  const Mask mask = to_mask(cells);
  Array<bool> result({mask.rows, mask.columns});
  cells_near(mask, resolution, reach, result.mutable_data());
  return result;
}

Array<bool> find_cells_within(const Array<bool>& cells, const Array<std::int64_t>& seeds, int steps) {
  const Mask mask = to_mask(cells);
  require(seeds.ndim() == 1, "seeds need the shape (n,)");
  const auto n = static_cast<std::size_t>(seeds.shape(0));
  require(std::all_of(seeds.data(), seeds.data() + n, [&](auto seed) { return seed >= 0 && seed < cells.size(); }),
          "seed lies outside of the grid");
  Array<bool> near({mask.rows, mask.columns});
  cells_within(mask.cells, mask.rows, mask.columns, seeds.data(), n, steps, near.mutable_data());
  return near;
}

Array<bool> find_connected(const Array<bool>& cells, py::ssize_t row, py::ssize_t column) {
  const Mask mask = to_mask(cells);
  require(is_inside(row, column, cells), "cell lies outside of the grid");
  Array<bool> part({mask.rows, mask.columns});
  connected_part(mask.cells, mask.rows, mask.columns, row * mask.columns + column, part.mutable_data());
  return part;
}

Array<bool> find_in_boxes(const Array<bool>& cells, const Array<std::int64_t>& middles, py::ssize_t reach) {
  const Mask mask = to_mask(cells);
  require(are_pairs(middles), "middles need the shape (n, 2)");
  Array<bool> near(middles.shape(0));
  any_in_box(mask.cells, mask.rows, mask.columns, middles.data(), static_cast<std::size_t>(middles.shape(0)), reach,
             near.mutable_data());
  return near;
}

}  // namespace

PYBIND11_MODULE(_kernels, module) {
  module.doc() = "Hot loops over grids and points. Cells are (row, column), lengths in metres.";
  py::class_<WeightedGrid>(module, "WeightedGrid")
      .def(py::init(&make_grid), py::arg("weights"), py::arg("resolution"),
           "8 neighbours a cell. weights: float32 (rows, columns), positive, infinite where there is no way; a step "
           "costs its length in metres times the mean weight of its two cells.")
      .def("costs_from", &costs_from, py::arg("row"), py::arg("column"),
           "Costs in metres from a cell to all: float64 (rows, columns), infinite where no path leads.")
      .def("path_to", &path_to, py::arg("row"), py::arg("column"), py::arg("costs"),
           "Cells of the cheapest path to a cell from the start of `costs`; empty where none leads.")
      .def("costs_between", &costs_between, py::arg("cells"),
           "Costs in metres between each two of n cells: float64 (n, n), symmetric, infinite where no path leads.");
  module.def("lines_are_clear", &clear_lines, py::arg("blocked"), py::arg("starts"), py::arg("ends"),
             "bool (n,): which lines between n pairs of cells, int64 (n, 2), pass no set cell of the bool array "
             "(rows, columns) and none outside; their ends do not count.");
  module.def("pooled_maximum", &pool, py::arg("values"), py::arg("mask"), py::arg("factor"),
             "Greatest of the float32 values (rows, columns) where the mask is set in each block of factor x factor "
             "cells, those at the far edges cut off; -1 where it is set nowhere.");
  module.def("frontier_cells", &find_frontier_cells, py::arg("cells"), py::arg("free_below"), py::arg("occupied_from"),
             py::arg("smallest_unknown"), py::arg("smallest_frontier"),
             "bool (rows, columns): which of the int8 cells, negative where unknown, are free, next to an unknown cell "
             "and not to an occupied one; without unknown islands and frontiers of fewer cells than the smallest.");
  module.def(
      "large_frontiers", &find_large_frontiers, py::arg("cells"), py::arg("columns"), py::arg("smallest"),
      "bool (n,): which frontier cells, ascending flat indices int64 (n,) of a grid with so many columns, belong "
      "to a frontier of at least that many.");
  module.def("changed_tiles", &find_changed_tiles, py::arg("before"), py::arg("after"), py::arg("edge"),
             "bool (ceil(rows / edge), ceil(columns / edge)): which tiles of two int8 grids (rows, columns) differ.");
  module.def(
      "connected_part", &find_connected, py::arg("cells"), py::arg("row"), py::arg("column"),
      "bool (rows, columns): the set cells of a bool array that are connected with one cell, 8 neighbours each.");
  module.def("cells_within", &find_cells_within, py::arg("cells"), py::arg("seeds"), py::arg("steps"),
             "bool (rows, columns): the set cells of a bool array that can be reached from the seeds, int64 (n,) flat "
             "indices of cells, through set cells, 8 neighbours each, in at most so many steps.");
  module.def("any_in_box", &find_in_boxes, py::arg("cells"), py::arg("middles"), py::arg("reach"),
             "bool (n,): around which middles, int64 (n, 2), a cell of a bool array (rows, columns) is set that is no "
             "more than `reach` rows and columns away.");
  module.def("near_any", &points_near_any, py::arg("points"), py::arg("places"), py::arg("distance"),
             "bool (n,): which of the float64 points (n, 2) have one of the places (m, 2) nearer than that.");
  module.def("within_any", &points_within_any, py::arg("points"), py::arg("places"), py::arg("distance"),
             "bool (n,): which of the float64 points (n, 2) have one of the places (m, 2) no farther than that.");
  module.def("nearest_near", &nearest_near_places, py::arg("points"), py::arg("places"), py::arg("distance"),
             "int64 (n,): which of the places (m, 2) is the nearest to each of the float64 points (n, 2), the first of "
             "several; -1 where none is nearer than that.");
  module.def(
      "unknown_behind", &find_unknown_behind, py::arg("cells"), py::arg("occupied_from"), py::arg("enterable"),
      py::arg("starts"), py::arg("reach"), py::arg("skipped"),
      "What 32 rays of `reach` cells show from each of the cells int64 (n, 2): float64 (n, 2), the unknown cells "
      "that they meet first, all and those that are enterable, a bool array of the shape of the int8 cells; and "
      "float64 (n,), cells, how deep the third deepest ray goes. Rays pass up to `skipped` known cells before.");
  module.def("thin", &thinned, py::arg("points"), py::arg("distance"),
             "Indices, int64, of the points (n, 2) that are kept: no two in each other's box of that half edge, the "
             "first ones first.");
  module.def(
      "nearest_views", &find_views, py::arg("coarse"), py::arg("labels"), py::arg("places"), py::arg("fine"),
      py::arg("blocked"), py::arg("points"), py::arg("groups"), py::arg("view_distance"),
      "For each point (n, 2) in metres the place nearest to it, int64 (n,), -1 if it is too far or blocked cells "
      "lie between. labels: int32 on the coarse grid, numbers from 1 on of the nearest of the places, which are "
      "int64 indices of its cells; blocked: bool on the fine grid; grids are placed by (resolution, x, y). groups: "
      "int64 (n,), ascending; the lines of a group are sampled as by `lines_are_clear`.");
  module.def("search_views", &find_views_around, py::arg("coarse"), py::arg("reachable"), py::arg("fine"),
             py::arg("blocked"), py::arg("points"), py::arg("view_distance"),
             "For each point (n, 2) in metres the first cell of the coarse grid, int64 (n,) flat indices, that is "
             "reachable, near enough and in sight, every third tried from near to far; -1 without one. Grids as in "
             "`nearest_views`, `reachable` a bool array on the coarse one.");
  module.def("components", &number_components, py::arg("count"), py::arg("edges"),
             "int64 (count,): the part of a graph with these edges, int64 (m, 2), that each node belongs to, numbered "
             "from 0 on in the order of their first nodes.");
  module.def(
      "distances_to", &distances, py::arg("cells"), py::arg("resolution"),
      "float32 (rows, columns): distance in metres from each cell to the nearest that is set in a bool array with "
      "cells of that edge length; one must be set.");
  module.def("cells_near", &near_cells, py::arg("cells"), py::arg("resolution"), py::arg("reach"),
             "bool (rows, columns): which of the distances of `distances_to` are less than `reach`, in metres.");
}
