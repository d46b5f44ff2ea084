// The part of the Python module that deals with cells of maps as such.
#pragma once

#include <pybind11/pybind11.h>

namespace map_merger {

void bind_cells(pybind11::module& module);

}  // namespace map_merger
