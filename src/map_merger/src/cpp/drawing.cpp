#include "drawing.hpp"

#include <cmath>
#include <initializer_list>

#include "cell_values.hpp"

namespace map_merger {

namespace {

// In cells. What lies on the border between two cells falls to the same one whatever rounding does.
constexpr double kTie = 1e-6;

std::int64_t cell_at(double position) { return static_cast<std::int64_t>(std::floor(position + kTie)); }

class Pen {
 public:
  Pen(const Affine& to_target, const Window& window, std::int8_t* drawn)
      : to_target_(to_target), window_(window), drawn_(drawn) {}

  void mark(double row, double column) const {
    const std::int64_t r = cell_at(to_target_.row(row, column)), c = cell_at(to_target_.column(row, column));
    if (r >= window_.top && r < window_.bottom && c >= window_.left && c < window_.right)
      drawn_[(r - window_.top) * (window_.right - window_.left) + c - window_.left] = kOccupied;
  }

 private:
  Affine to_target_;
  Window window_;
  std::int8_t* drawn_;
};

bool occupied(const MapCells& source, std::int64_t row, std::int64_t column) {
  return row >= 0 && column >= 0 && row < source.rows && column < source.columns &&
         source.at(row, column) >= kOccupiedFrom;
}

}  // namespace

void draw_under_centres(const MapCells& source, const Affine& to_source, const Window& window, std::int8_t* drawn) {
  for (std::int64_t r = window.top; r < window.bottom; ++r)
    for (std::int64_t c = window.left; c < window.right; ++c) {
      const double at_row = static_cast<double>(r), at_column = static_cast<double>(c);
      const std::int64_t row = cell_at(to_source.row(at_row, at_column)),
                         column = cell_at(to_source.column(at_row, at_column));
      const bool inside = row >= 0 && column >= 0 && row < source.rows && column < source.columns;
      *drawn++ = inside ? source.at(row, column) : kUnknown;
    }
}

void draw_links(const MapCells& source, const Window& part, const Affine& to_target, bool all, const Window& window,
                std::int8_t* drawn) {
  const Pen pen(to_target, window, drawn);
  for (std::int64_t row = part.top; row < part.bottom; ++row)
    for (std::int64_t column = part.left; column < part.right; ++column) {
      if (!occupied(source, row, column)) continue;
      const double r = static_cast<double>(row), c = static_cast<double>(column);
      if (all) pen.mark(r, c);
      if (occupied(source, row, column + 1)) continue;
      for (const std::int64_t step : {std::int64_t{1}, std::int64_t{-1}})
        if (occupied(source, row + step, column + 1) && !occupied(source, row + step, column))
          for (const double share : {0.0, 0.5, 1.0}) pen.mark(r + static_cast<double>(step) * share, c + share);
    }
}

}  // namespace map_merger
