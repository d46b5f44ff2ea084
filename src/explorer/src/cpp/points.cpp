#include "points.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <unordered_map>

#include "disjoint_sets.hpp"

namespace explorer {
namespace {

bool is_near_any(const double* point, const double* places, std::size_t m, double squared_distance) {
  for (std::size_t i = 0; i < m; ++i) {
    const double x = places[2 * i] - point[0], y = places[2 * i + 1] - point[1];
    if (x * x + y * y < squared_distance) return true;
  }
  return false;
}

bool is_within_any(const double* point, const double* places, std::size_t m, double distance) {
  for (std::size_t i = 0; i < m; ++i) {
    const double x = std::abs(places[2 * i] - point[0]), y = std::abs(places[2 * i + 1] - point[1]);
    if (x <= distance && y <= distance && std::hypot(x, y) <= distance) return true;
  }
  return false;
}

std::int64_t nearest_to(const double* point, const double* places, std::size_t m, double squared_distance) {
  // The lengths decide, their squares only spare most of them; the margin is for the rounding of either.
  const double most = squared_distance * (1.0 + 1e-9);
  double least = 0.0;
  std::int64_t nearest = -1;
  bool near = false;
  for (std::size_t i = 0; i < m; ++i) {
    const double x = places[2 * i] - point[0], y = places[2 * i + 1] - point[1], squared = x * x + y * y;
    if (!(squared <= most)) continue;
    near = near || squared < squared_distance;
    const double length = std::hypot(x, y);
    if (nearest >= 0 && length >= least) continue;
    nearest = static_cast<std::int64_t>(i);
    least = length;
  }
  return near ? nearest : -1;
}

// The points kept so far, by squares of edge `distance`.
class Kept {
 public:
  Kept(const double* points, double distance) : points_(points), distance_(distance) {}

  bool covers(double x, double y) const {
    const std::int64_t column = square_of(x), row = square_of(y);
    for (std::int64_t c = column - 1; c <= column + 1; ++c) {
      for (std::int64_t r = row - 1; r <= row + 1; ++r) {
        const auto square = squares_.find(key(c, r));
        if (square == squares_.end()) continue;
        for (const std::size_t i : square->second) {
          if (std::abs(points_[2 * i] - x) < distance_ && std::abs(points_[2 * i + 1] - y) < distance_) return true;
        }
      }
    }
    return false;
  }

  void add(std::size_t i) { squares_[key(square_of(points_[2 * i]), square_of(points_[2 * i + 1]))].push_back(i); }

 private:
  std::int64_t square_of(double value) const { return static_cast<std::int64_t>(std::floor(value / distance_)); }

  // Squares that share a key cost time, never the result.
  static std::uint64_t key(std::int64_t column, std::int64_t row) {
    return (static_cast<std::uint64_t>(column) << 32) ^ static_cast<std::uint64_t>(row & 0xFFFFFFFF);
  }

  const double* points_;
  double distance_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> squares_;
};

}  // namespace

void near_any(const double* points, std::size_t n, const double* places, std::size_t m, double distance, bool* near) {
  for (std::size_t i = 0; i < n; ++i) near[i] = is_near_any(points + 2 * i, places, m, distance * distance);
}

void within_any(const double* points, std::size_t n, const double* places, std::size_t m, double distance,
                bool* within) {
  for (std::size_t i = 0; i < n; ++i) within[i] = is_within_any(points + 2 * i, places, m, distance);
}

void nearest_near(const double* points, std::size_t n, const double* places, std::size_t m, double distance,
                  std::int64_t* nearest) {
  for (std::size_t i = 0; i < n; ++i) nearest[i] = nearest_to(points + 2 * i, places, m, distance * distance);
}

std::vector<std::size_t> thin(const double* points, std::size_t n, double distance) {
  Kept kept(points, distance);
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < n; ++i) {
    if (kept.covers(points[2 * i], points[2 * i + 1])) continue;
    kept.add(i);
    result.push_back(i);
  }
  return result;
}

std::vector<std::int64_t> components(std::size_t n, const std::int64_t* edges, std::size_t m) {
  DisjointSets sets(n);
  for (std::size_t i = 0; i < m; ++i) {
    const std::int64_t a = edges[2 * i], b = edges[2 * i + 1];
    const auto count = static_cast<std::int64_t>(n);
    if (a < 0 || b < 0 || a >= count || b >= count) throw std::out_of_range("an edge has no such node");
    sets.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  }
  std::vector<std::int64_t> numbers(n, -1), result(n);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    std::int64_t& number = numbers[sets.find(i)];
    if (number < 0) number = count++;
    result[i] = number;
  }
  return result;
}

}  // namespace explorer
