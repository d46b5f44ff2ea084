// Python module explorer._kernels.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <stdexcept>
#include <vector>

#include "lines.hpp"
#include "pooling.hpp"
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

bool are_pairs(const py::array& array) { return array.ndim() == 2 && array.shape(1) == 2; }

Array<bool> clear_lines(const Array<bool>& blocked, const Array<std::int64_t>& starts,
                        const Array<std::int64_t>& ends) {
  require(blocked.ndim() == 2, "blocked needs the shape (rows, columns)");
  require(are_pairs(starts) && are_pairs(ends) && starts.shape(0) == ends.shape(0), "lines need shapes (n, 2)");
  Array<bool> clear(starts.shape(0));
  const auto* cells = reinterpret_cast<const std::uint8_t*>(blocked.data());
  lines_are_clear(cells, blocked.shape(0), blocked.shape(1), starts.data(), ends.data(),
                  static_cast<std::size_t>(starts.shape(0)), clear.mutable_data());
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
}
