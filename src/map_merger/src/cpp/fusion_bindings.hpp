// The part of the Python module that makes one map of several.
#pragma once

#include <pybind11/pybind11.h>

namespace map_merger {

void bind_fusion(pybind11::module& module);

}  // namespace map_merger
