// Walls from an image file.
#pragma once

#include <string>

#include "medium/walls.hpp"

namespace adhoc_communication {

/// A binary PGM image (P5, 8 bits), as map_saver and every image program write it: what is darker than half is a wall.
/// Fills cells and width. Throws std::invalid_argument with one sentence that names the file.
void read_wall_image(const std::string& path, Walls& walls);

}  // namespace adhoc_communication
