#include "cells_bindings.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>
#include <tuple>
#include <vector>

#include "cells.hpp"
#include "require.hpp"

namespace py = pybind11;

namespace map_merger {
namespace {

using Cells = py::array_t<std::int8_t, py::array::c_style | py::array::forcecast>;
using Flags = py::array_t<bool, py::array::c_style | py::array::forcecast>;
// Written to in place, so never converted.
using Written = py::array_t<std::int8_t, py::array::c_style>;
using Stamps = py::array_t<std::int32_t, py::array::c_style>;
using Four = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

Four to_four(const Window& window) { return {window.top, window.left, window.bottom, window.right}; }

Four different_from(const std::int8_t* cells, std::int8_t value, std::int64_t rows, std::int64_t columns) {
  const std::vector<std::int8_t> other(static_cast<std::size_t>(columns), value);
  return to_four(window_of_differences(cells, other.data(), 0, rows, columns));
}

Four box_of_true(const Flags& mask) {
  require(mask.ndim() == 2, "a mask needs the shape (rows, columns)");
  return different_from(reinterpret_cast<const std::int8_t*>(mask.data()), 0, mask.shape(0), mask.shape(1));
}

Four box_of_others(const Cells& cells, std::int8_t value) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  return different_from(cells.data(), value, cells.shape(0), cells.shape(1));
}

Four box_of_changes(const Cells& before, const Cells& after) {
  require(
      before.ndim() == 2 && after.ndim() == 2 && before.shape(0) == after.shape(0) && before.shape(1) == after.shape(1),
      "maps are of one shape (rows, columns)");
  return to_four(window_of_differences(before.data(), after.data(), after.shape(1), before.shape(0), before.shape(1)));
}

Four write(Written& store, std::optional<Stamps>& stamps, std::int64_t top, std::int64_t left, const Cells& cells,
           std::int32_t stamp, bool known_only) {
  require(store.ndim() == 2 && cells.ndim() == 2, "cells need the shape (rows, columns)");
  const Window window{top, left, top + cells.shape(0), left + cells.shape(1)};
  require(top >= 0 && left >= 0 && window.bottom <= store.shape(0) && window.right <= store.shape(1),
          "the cells lie in the store");
  require(!stamps || (stamps->ndim() == 2 && stamps->shape(0) == store.shape(0) && stamps->shape(1) == store.shape(1)),
          "store and stamps are of one shape");
  const Store into{store.mutable_data(), stamps ? stamps->mutable_data() : nullptr, store.shape(1)};
  return to_four(write_cells(into, window, cells.data(), stamp, known_only));
}

}  // namespace

void bind_cells(py::module& module) {
  module.def("box_of_true", &box_of_true, py::arg("mask"),
             "(top, left, bottom, right), the last two not included, around the true cells, bool (rows, columns); all "
             "0 if there are none.");
  module.def("box_of_others", &box_of_others, py::arg("cells"), py::arg("value"),
             "The same around the cells, int8 (rows, columns), of another value.");
  module.def("box_of_changes", &box_of_changes, py::arg("before"), py::arg("after"),
             "The same around the cells in which two maps, int8 (rows, columns), differ.");
  module.def("write_cells", &write, py::arg("store").noconvert(), py::arg("stamps").noconvert(), py::arg("top"),
             py::arg("left"), py::arg("cells"), py::arg("stamp"), py::arg("known_only"),
             "Writes cells, int8 (rows, columns), into the store, int8, from row `top` and column `left` on. stamps: "
             "int32 like the store or None; cells with a higher one stay, the others get `stamp`. known_only: unknown "
             "cells, -1, say nothing. Returns the box around what changed, counted like the store.");
}

}  // namespace map_merger
