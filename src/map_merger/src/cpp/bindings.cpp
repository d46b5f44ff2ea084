// Python module map_merger._surface_index.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "surface_index.hpp"

namespace py = pybind11;
using namespace map_merger;

namespace {

using Pairs = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<OrientedPoint> to_points(const Pairs& places, const Pairs& normals) {
  if (places.ndim() != 2 || places.shape(1) != 2 || normals.ndim() != 2 || normals.shape(1) != 2 ||
      places.shape(0) != normals.shape(0)) {
    throw std::invalid_argument("points and normals need the same shape (n, 2)");
  }
  std::vector<OrientedPoint> points(static_cast<std::size_t>(places.shape(0)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {places.data()[2 * i], places.data()[2 * i + 1], normals.data()[2 * i], normals.data()[2 * i + 1]};
    const OrientedPoint& point = points[i];
    if (!std::isfinite(point.x + point.y + point.normal_x + point.normal_y)) {
      throw std::invalid_argument("points and normals must be finite");
    }
  }
  return points;
}

SurfaceIndex make_index(const Pairs& points, const Pairs& normals, double normal_weight) {
  std::vector<OrientedPoint> oriented = to_points(points, normals);
  py::gil_scoped_release release;
  return SurfaceIndex(std::move(oriented), normal_weight);
}

py::array_t<std::int64_t> nearest(const SurfaceIndex& index, const Pairs& points, const Pairs& normals, double bound) {
  const std::vector<OrientedPoint> queries = to_points(points, normals);
  py::array_t<std::int64_t> numbers(static_cast<py::ssize_t>(queries.size()));
  std::int64_t* number = numbers.mutable_data();
  // Other threads of the node go on while this one searches.
  py::gil_scoped_release release;
  for (const OrientedPoint& query : queries) *number++ = index.nearest(query, bound);
  return numbers;
}

}  // namespace

PYBIND11_MODULE(_surface_index, module) {
  module.doc() = "Search for the nearest like-facing point of a surface. Lengths in metres.";
  py::class_<SurfaceIndex>(module, "SurfaceIndex")
      .def(py::init(&make_index), py::arg("points"), py::arg("normals"), py::arg("normal_weight"),
           "points, normals: float64 (n, 2). normal_weight: metres that a unit difference of the normals counts.")
      .def("nearest", &nearest, py::arg("points"), py::arg("normals"), py::arg("bound"),
           "For each of the oriented points (m, 2) the number of the nearest one of the surface, int64 (m,), -1 where "
           "all are `bound` metres or more away.");
}
