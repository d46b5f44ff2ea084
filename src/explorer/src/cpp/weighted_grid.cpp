#include "weighted_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace explorer {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<Cell, 8> kNeighbours = {{{-1, -1}, {-1, 1}, {1, -1}, {1, 1}, {-1, 0}, {0, -1}, {0, 1}, {1, 0}}};

// At least as many as the longest step spans, so that the buckets can be used in turn; a power of two.
std::size_t bucket_count(float heaviest_by_lightest) {
  std::size_t count = 4;
  while (count < 1.5F * heaviest_by_lightest + 2.0F) count *= 2;
  return count;
}

}  // namespace

// Dijkstra's algorithm with buckets a little narrower than the shortest step (Denardo and Fox, Shortest-route methods,
// 1979): no cell in the lowest bucket can improve another one there, so they are final in any order.
class WeightedGrid::Search {
 public:
  explicit Search(const WeightedGrid& grid)
      : weights_(grid.weights_.data()),
        straight_(grid.straight_),
        diagonal_(grid.diagonal_),
        buckets_per_metre_(1.01 / (grid.resolution_ * grid.least_)),
        costs_(grid.weights_.size(), kInfinity),
        final_(grid.weights_.size(), 0),
        buckets_(bucket_count(grid.greatest_ / grid.least_)) {
    const std::ptrdiff_t stride = grid.stride_;
    straight_offsets_ = {-stride, -1, 1, stride};
    diagonal_offsets_ = {-stride - 1, -stride + 1, stride - 1, stride + 1};
  }

  // Until the cells `awaited` are final, or with none all cells that can be reached.
  void run(std::size_t start, const std::size_t* awaited, const std::size_t* awaited_end) {
    if (!std::isfinite(weights_[start])) return;
    const bool all = awaited == awaited_end;
    costs_[start] = 0.0;
    buckets_[0].push_back(static_cast<std::int32_t>(start));
    queued_ = 1;
    for (std::size_t turn = 0; queued_ > 0; ++turn) {
      std::vector<std::int32_t>& bucket = buckets_[turn & (buckets_.size() - 1)];
      for (const std::int32_t index : bucket) settle(static_cast<std::size_t>(index));
      queued_ -= bucket.size();
      bucket.clear();
      while (awaited != awaited_end && final_[*awaited]) ++awaited;
      if (!all && awaited == awaited_end) return;
    }
  }

  double cost(std::size_t index) const { return costs_[index]; }
  const double* costs() const { return costs_.data(); }

 private:
  void settle(std::size_t index) {
    if (final_[index]) return;
    final_[index] = 1;
    const double cost = costs_[index];
    for (const std::ptrdiff_t offset : straight_offsets_) reach(index + offset, cost, weights_[index], straight_);
    for (const std::ptrdiff_t offset : diagonal_offsets_) reach(index + offset, cost, weights_[index], diagonal_);
  }

  void reach(std::size_t index, double cost, float weight, float half_length) {
    const double candidate = cost + static_cast<double>((weight + weights_[index]) * half_length);
    if (!(candidate < costs_[index])) return;
    costs_[index] = candidate;
    buckets_[static_cast<std::size_t>(candidate * buckets_per_metre_) & (buckets_.size() - 1)].push_back(
        static_cast<std::int32_t>(index));
    ++queued_;
  }

  const float* weights_;
  float straight_, diagonal_;
  double buckets_per_metre_;
  std::vector<double> costs_;
  std::vector<std::uint8_t> final_;
  std::vector<std::vector<std::int32_t>> buckets_;
  std::size_t queued_ = 0;
  std::array<std::ptrdiff_t, 4> straight_offsets_, diagonal_offsets_;
};

WeightedGrid::WeightedGrid(const float* weights, int rows, int columns, double resolution)
    : rows_(rows),
      columns_(columns),
      stride_(columns + 2),
      resolution_(resolution),
      straight_(static_cast<float>(0.5 * resolution)),
      diagonal_(static_cast<float>(0.5 * resolution * std::sqrt(2.0))),
      weights_(static_cast<std::size_t>(rows + 2) * (columns + 2), std::numeric_limits<float>::infinity()),
      least_(std::numeric_limits<float>::infinity()),
      greatest_(0.0F) {
  for (int row = 0; row < rows; ++row) {
    std::copy_n(weights + static_cast<std::ptrdiff_t>(row) * columns, columns,
                weights_.begin() + (row + 1) * stride_ + 1);
  }
  for (const float weight : weights_) {
    if (!(weight > 0.0F)) throw std::invalid_argument("weights must be positive");
    if (!std::isfinite(weight)) continue;
    least_ = std::min(least_, weight);
    greatest_ = std::max(greatest_, weight);
  }
  if (!std::isfinite(least_)) least_ = greatest_ = 1.0F;
  // Beyond this the buckets would take more room than the grid.
  if (greatest_ > 1e4F * least_) throw std::invalid_argument("weights must be within a factor of 10000");
}

bool WeightedGrid::contains(const Cell& cell) const {
  return cell.first >= 0 && cell.second >= 0 && cell.first < rows_ && cell.second < columns_;
}

std::size_t WeightedGrid::index_of(const Cell& cell) const {
  if (!contains(cell)) throw std::out_of_range("cell lies outside of the grid");
  return static_cast<std::size_t>((cell.first + 1) * stride_ + cell.second + 1);
}

void WeightedGrid::costs_from(const Cell& start, double* costs) const {
  Search search(*this);
  search.run(index_of(start), nullptr, nullptr);
  for (int row = 0; row < rows_; ++row) {
    std::copy_n(search.costs() + (row + 1) * stride_ + 1, columns_,
                costs + static_cast<std::ptrdiff_t>(row) * columns_);
  }
}

std::vector<Cell> WeightedGrid::path_to(const Cell& end, const double* costs) const {
  const auto cost_of = [&](const Cell& cell) {
    return contains(cell) ? costs[static_cast<std::ptrdiff_t>(cell.first) * columns_ + cell.second] : kInfinity;
  };
  std::vector<Cell> path;
  if (!std::isfinite(cost_of(end))) return path;
  path.push_back(end);
  while (cost_of(path.back()) > 0.0) {
    const Cell here = path.back();
    Cell best = here;
    double least = kInfinity;
    for (const auto& [down, right] : kNeighbours) {
      const Cell next{here.first + down, here.second + right};
      const double cost = cost_of(next);
      if (!(cost < cost_of(here))) continue;
      const float half_length = down && right ? diagonal_ : straight_;
      const double sum =
          cost + static_cast<double>((weights_[index_of(here)] + weights_[index_of(next)]) * half_length);
      if (sum < least) least = sum, best = next;
    }
    if (best == here) throw std::invalid_argument("costs are not those of this grid");
    path.push_back(best);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<double> WeightedGrid::costs_between(const std::vector<Cell>& cells) const {
  const std::size_t n = cells.size();
  std::vector<std::size_t> indices;
  for (const Cell& cell : cells) indices.push_back(index_of(cell));
  std::vector<double> costs(n * n, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    Search search(*this);
    search.run(indices[i], &indices[i] + 1, indices.data() + n);
    for (std::size_t j = i + 1; j < n; ++j) costs[i * n + j] = costs[j * n + i] = search.cost(indices[j]);
  }
  return costs;
}

}  // namespace explorer
