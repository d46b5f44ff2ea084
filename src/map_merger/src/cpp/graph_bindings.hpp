// The part of the Python module that solves pose graphs.
#pragma once

#include <pybind11/pybind11.h>

namespace map_merger {

void bind_graph(pybind11::module& module);

}  // namespace map_merger
