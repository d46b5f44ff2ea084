// Drawing a map on the lattice of another one.
#pragma once

#include <cstdint>

namespace map_merger {

// column = x[0] + x[1] * c + x[2] * r and row = y[0] + y[1] * c + y[2] * r: what lies in another grid, with fraction,
// under the middle of the cell in row r and column c.
struct Affine {
  double x[3], y[3];

  double column(double r, double c) const { return x[0] + x[1] * c + x[2] * r; }
  double row(double r, double c) const { return y[0] + y[1] * c + y[2] * r; }
};

// Half-open rectangle of cells.
struct Window {
  std::int64_t top, left, bottom, right;
};

// Cells of a map: -1 unknown, 0 free to 100 occupied.
struct MapCells {
  const std::int8_t* cells;
  std::int64_t rows, columns;

  std::int8_t at(std::int64_t row, std::int64_t column) const { return cells[row * columns + column]; }
};

// Each cell of the window takes the value of the source cell under its middle, unknown beyond the source. `to_source`
// counts from the lattice of the window. A cell does not depend on the window it is drawn in.
void draw_under_centres(const MapCells& source, const Affine& to_source, const Window& window, std::int8_t* drawn);

// Walls that hang together only at corners of cells would break: draws the links between the source cells of `part`
// (centre, corner, centre), with `all` the centres of all obstacles, too. `to_target` counts from the middles of the
// source cells and is the inverse of `to_source`.
void draw_links(const MapCells& source, const Window& part, const Affine& to_target, bool all, const Window& window,
                std::int8_t* drawn);

}  // namespace map_merger
