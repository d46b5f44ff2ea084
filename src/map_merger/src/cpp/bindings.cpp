// Python module map_merger._surfaces.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "border.hpp"
#include "cells_bindings.hpp"
#include "comparison.hpp"
#include "drawing.hpp"
#include "fusion_bindings.hpp"
#include "graph_bindings.hpp"
#include "refinement.hpp"
#include "require.hpp"
#include "surface_index.hpp"
#include "walls.hpp"
#include "weighing.hpp"

namespace py = pybind11;
using namespace map_merger;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Flags = py::array_t<bool, py::array::c_style>;
using PoseTuple = std::tuple<double, double, double>;

Pose to_pose(const PoseTuple& pose) { return {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)}; }

PoseTuple to_tuple(const Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

const std::uint8_t* bytes_of(const Flags& flags) { return reinterpret_cast<const std::uint8_t*>(flags.data()); }

Raster to_raster(const Flags& cells, double resolution, const PoseTuple& origin) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  require(std::isfinite(resolution) && resolution > 0.0, "a resolution is positive");
  require(std::isfinite(std::get<0>(origin) + std::get<1>(origin) + std::get<2>(origin)), "an origin is finite");
  return {{bytes_of(cells), static_cast<int>(cells.shape(0)), static_cast<int>(cells.shape(1))},
          resolution,
          to_pose(origin)};
}

std::vector<OrientedPoint> to_points(const Doubles& places, const Doubles& normals) {
  require(places.ndim() == 2 && places.shape(1) == 2 && normals.ndim() == 2 && normals.shape(1) == 2 &&
              places.shape(0) == normals.shape(0),
          "points and normals need the same shape (n, 2)");
  std::vector<OrientedPoint> points(static_cast<std::size_t>(places.shape(0)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {places.data()[2 * i], places.data()[2 * i + 1], normals.data()[2 * i], normals.data()[2 * i + 1]};
    const OrientedPoint& point = points[i];
    require(std::isfinite(point.x + point.y + point.normal_x + point.normal_y), "points and normals must be finite");
  }
  return points;
}

SurfaceIndex make_index(const Doubles& points, const Doubles& normals, double normal_weight) {
  std::vector<OrientedPoint> oriented = to_points(points, normals);
  py::gil_scoped_release release;
  return SurfaceIndex(std::move(oriented), normal_weight);
}

py::array_t<std::int64_t> nearest(const SurfaceIndex& index, const Doubles& points, const Doubles& normals,
                                  double bound) {
  const std::vector<OrientedPoint> queries = to_points(points, normals);
  py::array_t<std::int64_t> numbers(static_cast<py::ssize_t>(queries.size()));
  std::int64_t* number = numbers.mutable_data();
  // Other threads of the node go on while this one searches.
  py::gil_scoped_release release;
  for (const OrientedPoint& query : queries) *number++ = index.nearest(query, bound);
  return numbers;
}

PoseTuple refine(const SurfaceIndex& index, const Doubles& points, const Doubles& normals, const PoseTuple& start,
                 const std::vector<double>& reaches) {
  const std::vector<OrientedPoint> source = to_points(points, normals);
  py::gil_scoped_release release;
  return to_tuple(refined(index, source, to_pose(start), reaches));
}

Comparison compare_with(const SurfaceIndex& index, const Flags& known, const Flags& clear, double resolution,
                        const PoseTuple& origin, const Doubles& points, const Doubles& normals, const Flags& solid,
                        const PoseTuple& transform, double tolerance) {
  const Raster raster = to_raster(known, resolution, origin);
  require(clear.ndim() == 2 && clear.shape(0) == known.shape(0) && clear.shape(1) == known.shape(1),
          "known and clear need the same shape");
  const std::vector<OrientedPoint> source = to_points(points, normals);
  require(solid.ndim() == 1 && solid.size() == points.shape(0), "solid needs a value for each point");
  py::gil_scoped_release release;
  return compare(index, raster, bytes_of(clear), source, bytes_of(solid), to_pose(transform), tolerance);
}

py::tuple border(const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>& obstacles,
                 const Flags& free, double resolution, const PoseTuple& origin) {
  require(obstacles.ndim() == 2 && obstacles.shape(1) == 2, "obstacles need the shape (n, 2)");
  const Raster raster = to_raster(free, resolution, origin);
  std::vector<mr_grid::Cell> cells(static_cast<std::size_t>(obstacles.shape(0)));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::int64_t row = obstacles.data()[2 * i], column = obstacles.data()[2 * i + 1];
    require(row >= 0 && column >= 0 && row < raster.rows && column < raster.columns, "an obstacle is off the map");
    cells[i] = {static_cast<int>(row), static_cast<int>(column)};
  }
  std::vector<BorderPoint> found;
  {
    py::gil_scoped_release release;
    found = border_of(cells, raster);
  }
  const py::ssize_t count = static_cast<py::ssize_t>(found.size());
  Doubles points({count, py::ssize_t{2}}), normals({count, py::ssize_t{2}});
  py::array_t<std::int64_t> numbers(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const OrientedPoint& point = found[i].point;
    points.mutable_at(i, 0) = point.x, points.mutable_at(i, 1) = point.y;
    normals.mutable_at(i, 0) = point.normal_x, normals.mutable_at(i, 1) = point.normal_y;
    numbers.mutable_at(i) = static_cast<std::int64_t>(found[i].cell);
  }
  return py::make_tuple(points, normals, numbers);
}

py::tuple walls(const py::array_t<std::int8_t, py::array::c_style | py::array::forcecast>& cells, std::int64_t smallest,
                double largest_mover) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  Walls found;
  {
    const std::int8_t* first = cells.data();
    const std::int64_t rows = cells.shape(0), columns = cells.shape(1);
    py::gil_scoped_release release;
    found = walls_of(known_of(first, rows, columns).wall, smallest, largest_mover);
  }
  const py::ssize_t count = static_cast<py::ssize_t>(found.cells.size());
  py::array_t<std::int64_t> places({count, py::ssize_t{2}});
  py::array_t<bool> large(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::size_t>(i);
    places.mutable_at(i, 0) = found.cells[number].row, places.mutable_at(i, 1) = found.cells[number].column;
    large.mutable_at(i) = found.large[number];
  }
  return py::make_tuple(places, large);
}

Flags without_discs(const Flags& cells,
                    const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>& places, double radius) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  require(places.ndim() == 2 && places.shape(1) == 2, "places need the shape (n, 2)");
  require(radius >= 0.0 && radius < 1000.0, "a radius is 0 to 1000 cells");
  std::vector<mr_grid::Cell> centres;
  for (py::ssize_t i = 0; i < places.shape(0); ++i) {
    const std::int64_t row = places.at(i, 0), column = places.at(i, 1);
    require(row >= 0 && column >= 0 && row < cells.shape(0) && column < cells.shape(1), "a place is off the map");
    centres.push_back({static_cast<int>(row), static_cast<int>(column)});
  }
  Flags left({cells.shape(0), cells.shape(1)});
  auto* first = reinterpret_cast<std::uint8_t*>(left.mutable_data());
  std::copy_n(bytes_of(cells), cells.size(), first);
  py::gil_scoped_release release;
  clear_discs(first, cells.shape(0), cells.shape(1), centres, radius);
  return left;
}

py::array_t<float> raster(const Doubles& points, const PoseTuple& transform, std::pair<double, double> corner,
                          double cell, std::pair<py::ssize_t, py::ssize_t> shape, float weight) {
  require(points.ndim() == 2 && points.shape(1) == 2, "points need the shape (n, 2)");
  const auto [rows, columns] = shape;
  py::array_t<float> result({rows, columns});
  float* cells = result.mutable_data();
  std::fill_n(cells, result.size(), 0.0F);
  const Frame frame(to_pose(transform));
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    const mr_grid::Point moved = frame * mr_grid::Point{points.at(i, 0), points.at(i, 1)};
    const double column = std::floor((moved.x - corner.first) / cell),
                 row = std::floor((moved.y - corner.second) / cell);
    require(row >= 0.0 && row < static_cast<double>(rows) && column >= 0.0 && column < static_cast<double>(columns),
            "a point lies outside the raster");
    cells[static_cast<py::ssize_t>(row) * columns + static_cast<py::ssize_t>(column)] += weight;
  }
  return result;
}

using Cells = py::array_t<std::int8_t, py::array::c_style | py::array::forcecast>;
using Six = std::array<double, 6>;
using Four = std::array<std::int64_t, 4>;

Affine to_affine(const Six& values) {
  for (const double value : values) require(std::isfinite(value), "a mapping of cells is finite");
  return {{values[0], values[1], values[2]}, {values[3], values[4], values[5]}};
}

py::array_t<std::int8_t> draw(const Cells& cells, const Six& to_source, const Six& to_target, const Four& part,
                              const Four& box, bool all) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  const MapCells source{cells.data(), cells.shape(0), cells.shape(1)};
  const Window from{part[0], part[1], part[2], part[3]}, window{box[0], box[1], box[2], box[3]};
  require(from.top >= 0 && from.left >= 0 && from.bottom <= source.rows && from.right <= source.columns,
          "the part lies in the source");
  require(window.top <= window.bottom && window.left <= window.right, "a box is not inverted");
  const Affine back = to_affine(to_source), forth = to_affine(to_target);
  py::array_t<std::int8_t> drawn({window.bottom - window.top, window.right - window.left});
  std::int8_t* first = drawn.mutable_data();
  py::gil_scoped_release release;
  draw_under_centres(source, back, window, first);
  draw_links(source, from, forth, all, window, first);
  return drawn;
}

}  // namespace

PYBIND11_MODULE(_surfaces, module) {
  module.doc() = "Walls as oriented points. Lengths in metres, transforms as (x, y, yaw).";

  py::class_<Comparison>(module, "Comparison")
      .def_readonly("inside", &Comparison::inside)
      .def_readonly("matched", &Comparison::matched)
      .def_readonly("contradicted", &Comparison::contradicted)
      .def_readonly("minor", &Comparison::minor)
      .def_readonly("mean_square", &Comparison::mean_square)
      .def_property_readonly("middle", [](const Comparison& own) { return std::make_pair(own.middle_x, own.middle_y); })
      .def_property_readonly("information", [](const Comparison& own) {
        const auto& [xx, xy, xt, yy, yt, tt] = own.information;
        return std::array<std::array<double, 3>, 3>{{{xx, xy, xt}, {xy, yy, yt}, {xt, yt, tt}}};
      });

  py::class_<SurfaceIndex>(module, "SurfaceIndex")
      .def(py::init(&make_index), py::arg("points"), py::arg("normals"), py::arg("normal_weight"),
           "points, normals: float64 (n, 2). normal_weight: metres that a unit difference of the normals counts.")
      .def("nearest", &nearest, py::arg("points"), py::arg("normals"), py::arg("bound"),
           "For each of the oriented points (m, 2) the number of the nearest one of the surface, int64 (m,), -1 where "
           "all are `bound` metres or more away.")
      .def("refined", &refine, py::arg("points"), py::arg("normals"), py::arg("start"), py::arg("reaches"),
           "The transform near `start` that lays the oriented points (m, 2) on the surface; reaches: search distances "
           "in metres, one per iteration.")
      .def("compare", &compare_with, py::arg("known"), py::arg("clear"), py::arg("resolution"), py::arg("origin"),
           py::arg("points"), py::arg("normals"), py::arg("solid"), py::arg("transform"), py::arg("tolerance"),
           "How the oriented points (m, 2), moved by `transform`, agree with the surface and its map: known, clear: "
           "bool (rows, columns); solid: bool (m,).");

  module.def(
      "raster", &raster, py::arg("points"), py::arg("transform"), py::arg("corner"), py::arg("cell"), py::arg("shape"),
      py::arg("weight"),
      "float32 (rows, columns): `weight` for each of the transformed points (n, 2) in its cell of `cell` metres; "
      "cell (0, 0) has its corner at `corner`.");
  module.def("border", &border, py::arg("obstacles"), py::arg("free"), py::arg("resolution"), py::arg("origin"),
             "Faces of the obstacle cells (n, 2: row, column) to free cells, bool (rows, columns): points and normals, "
             "float64 (m, 2), and the numbers of the cells they belong to, int64 (m,).");
  module.def("walls", &walls, py::arg("cells"), py::arg("smallest"), py::arg("largest_mover"),
             "Cells of the obstacles of `smallest` cells or more in a map, int8 (rows, columns): int64 (n, 2: row, "
             "column), row by row; and whether the extent of each one's obstacle is more than `largest_mover` cells, "
             "bool (n,).");
  module.def("without_discs", &without_discs, py::arg("cells"), py::arg("places"), py::arg("radius"),
             "The cells, bool (rows, columns), false where they are at most `radius` cells from one of the places, "
             "(n, 2: row, column).");
  module.def("draw", &draw, py::arg("cells"), py::arg("to_source"), py::arg("to_target"), py::arg("part"),
             py::arg("box"), py::arg("all_walls"),
             "int8 (rows, columns) of `box` (top, left, bottom, right): the value of the cell under each middle, and "
             "the links of walls in `part` of the cells. to_source: (x0, x1, x2, y0, y1, y2) of column = x0 + x1 * c "
             "+ x2 * r and row = y0 + y1 * c + y2 * r; to_target: its inverse.");
  bind_cells(module);
  bind_fusion(module);
  bind_graph(module);
}
