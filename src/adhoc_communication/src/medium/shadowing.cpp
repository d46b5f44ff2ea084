#include "medium/shadowing.hpp"

#include <algorithm>
#include <cmath>

#include "random.hpp"

namespace adhoc_communication {
namespace {

/// Nearly normal, mean 0, standard deviation 1. A sum, because log() and cos() differ from machine to machine.
double normal(Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

std::uint64_t as_key(double index) {
  constexpr double kFarthest = 1e15;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::clamp(index, -kFarthest, kFarthest)));
}

}  // namespace

double Shadowing::corner(double column, double row) const {
  Random of_column(seed_ ^ as_key(column));
  Random of_corner(of_column.next() ^ as_key(row));
  return normal(of_corner);
}

double Shadowing::at(const Position& position) const {
  if (!exists()) return 0.0;
  const double x = position.x / options_.distance;
  const double y = position.y / options_.distance;
  const double column = std::floor(x);
  const double row = std::floor(y);
  double sum = 0.0, squares = 0.0;
  for (const double right : {0.0, 1.0}) {
    for (const double up : {0.0, 1.0}) {
      const double weight = (1.0 - std::abs(x - column - right)) * (1.0 - std::abs(y - row - up));
      sum += weight * corner(column + right, row + up);
      squares += weight * weight;
    }
  }
  return squares > 0.0 ? sum / std::sqrt(squares) : 0.0;  // as spread in the middle of a square as at its corners
}

double Shadowing::between(double here, double there) const {
  return options_.deviation * std::clamp((here + there) * std::sqrt(0.5), -kLimit, kLimit);
}

}  // namespace adhoc_communication
