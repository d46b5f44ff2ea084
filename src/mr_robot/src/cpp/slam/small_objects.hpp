// Which beams of a scan hit something small that stands free, as robots and people do?
#pragma once

#include "scan.hpp"

namespace mr_robot::slam {

// Sets `on_small_object` of the hits on what is less than `size` (m) from end to end. To be called when all beams have
// their ends.
void mark_small_objects(Scan& scan, double size);

}  // namespace mr_robot::slam
