// Arguments of a module's functions.
#pragma once

#include <stdexcept>

namespace map_merger {

inline void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace map_merger
