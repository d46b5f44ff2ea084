#include "march.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace mr_sim::navigation {
namespace {

// A priority queue for costs that grow while it is used: buckets so narrow that few cells have to be put in order at
// a time, and hardly any is put into the cheapest.
class Front {
 public:
  struct Cell {
    float cost;
    int index;
  };

  void push(float cost, int index) {
    const int bucket = static_cast<int>(std::clamp(cost * kPerCost, 0.0F, kBuckets - 1.0F));
    if (bucket <= current_) {
      const auto place = std::upper_bound(cheapest_.begin(), cheapest_.end(), cost,
                                          [](float least, const Cell& cell) { return least > cell.cost; });
      cheapest_.insert(place, {cost, index});
      return;
    }
    if (bucket >= static_cast<int>(heads_.size())) heads_.resize(bucket + 1, -1);
    links_.push_back({{cost, index}, heads_[bucket]});
    heads_[bucket] = static_cast<int>(links_.size()) - 1;
  }

  // Whether there was one.
  bool pop(Cell& cell) {
    while (cheapest_.empty()) {
      if (++current_ >= static_cast<int>(heads_.size())) return false;
      for (int link = heads_[current_]; link >= 0; link = links_[link].next) cheapest_.push_back(links_[link].cell);
      std::sort(cheapest_.begin(), cheapest_.end(), [](const Cell& a, const Cell& b) { return a.cost > b.cost; });
    }
    cell = cheapest_.back();
    cheapest_.pop_back();
    return true;
  }

 private:
  static constexpr float kPerCost = 32.0F;
  static constexpr int kBuckets = 1 << 18;  // the last for all costs from there on
  struct Link {
    Cell cell;
    int next;
  };
  std::vector<Link> links_;
  std::vector<int> heads_;
  std::vector<Cell> cheapest_;  // the cheapest last
  int current_ = -1;
};

// Upwind solution of (T - a)^2 + (T - b)^2 = f^2 with the lesser neighbours a, b of each axis.
float solve(float a, float b, float f) {
  if (a > b) std::swap(a, b);
  if (b - a >= f) return a + f;
  return 0.5F * (a + b + std::sqrt(2.0F * f * f - (a - b) * (a - b)));
}

struct Node {
  float slowness = kUnreached;
  float cost = kUnreached;    // final, or kUnreached
  float least = -kUnreached;  // offered so far; minus infinity where blocked
};

// One march. Its grid has a rim of one blocked cell, so that every cell has four neighbours.
class March {
 public:
  // `nodes`: memory to work in, kept by the caller because fresh pages cost more than the march itself.
  March(const float* slowness, int rows, int columns, std::vector<Node>& nodes)
      : rows_(rows), columns_(columns), stride_(columns + 2), nodes_(nodes) {
    nodes_.assign(static_cast<std::size_t>(rows + 2) * stride_, Node{});
    for_each_cell([&](int index, std::size_t plain) {
      const float value = slowness[plain];
      nodes_[index].slowness = value;
      nodes_[index].least = value < kUnreached ? kUnreached : -kUnreached;
    });
  }

  void seed(const Seed& seed) { offer(at(seed.row, seed.column), seed.cost); }

  // Takes over the costs that no change of the slowness can reach, and lets the front begin beside them.
  void take_over(const Former& former) {
    const float bound = changed_from(former);
    for_each_cell([&](int index, std::size_t plain) {
      if (former.cost[plain] < bound) nodes_[index].cost = nodes_[index].least = former.cost[plain];
    });
    for_each_cell([&](int index, std::size_t) {
      if (nodes_[index].least == kUnreached && beside_final(index)) offer(index, upwind(index));
    });
  }

  void run(const Stop& stop) {
    const int goal = stop.row < 0 ? -1 : at(stop.row, stop.column);
    limit_ = stop.limit;
    if (goal >= 0 && nodes_[goal].cost < kUnreached) limit_ = std::min(limit_, nodes_[goal].cost + stop.beyond);
    Front::Cell top;
    while (front_.pop(top)) {
      if (top.cost > limit_) break;
      if (nodes_[top.index].cost < kUnreached) continue;
      nodes_[top.index].cost = top.cost;
      if (top.index == goal) limit_ = std::min(limit_, top.cost + stop.beyond);
      for (const int neighbour : {top.index - stride_, top.index + stride_, top.index - 1, top.index + 1}) {
        // Blocked cells and those with their final cost ask for nothing less.
        if (nodes_[neighbour].least > top.cost) offer(neighbour, upwind(neighbour));
      }
    }
  }

  void write(float* result) const {
    for_each_cell([&](int index, std::size_t plain) { result[plain] = nodes_[index].cost; });
  }

 private:
  int at(int row, int column) const { return (row + 1) * stride_ + column + 1; }

  template <typename Function>
  void for_each_cell(Function function) const {
    std::size_t plain = 0;
    for (int row = 0; row < rows_; ++row) {
      for (int index = at(row, 0), end = index + columns_; index < end; ++index) function(index, plain++);
    }
  }

  float beside(int index) const { return std::min(nodes_[index - 1].cost, nodes_[index + 1].cost); }
  float above_or_below(int index) const { return std::min(nodes_[index - stride_].cost, nodes_[index + stride_].cost); }

  // Of a cell beside one with a final cost.
  float upwind(int index) const { return solve(above_or_below(index), beside(index), nodes_[index].slowness); }

  bool beside_final(int index) const { return std::min(above_or_below(index), beside(index)) < kUnreached; }

  void offer(int index, float cost) {
    if (!(cost < nodes_[index].least) || cost > limit_) return;
    nodes_[index].least = cost;
    front_.push(cost, index);
  }

  // The least cost that a cell of another slowness, now or formerly, can have: its own or that of a neighbour.
  float changed_from(const Former& former) const {
    float bound = kUnreached;
    const std::size_t columns = columns_;
    for_each_cell([&](int index, std::size_t plain) {
      if (former.slowness[plain] == nodes_[index].slowness) return;
      const std::size_t row = plain / columns, column = plain % columns;
      bound = std::min(bound, former.cost[plain]);
      if (row > 0) bound = std::min(bound, former.cost[plain - columns]);
      if (row + 1 < static_cast<std::size_t>(rows_)) bound = std::min(bound, former.cost[plain + columns]);
      if (column > 0) bound = std::min(bound, former.cost[plain - 1]);
      if (column + 1 < columns) bound = std::min(bound, former.cost[plain + 1]);
    });
    return bound;
  }

  int rows_, columns_, stride_;
  std::vector<Node>& nodes_;
  Front front_;
  float limit_ = kUnreached;
};

}  // namespace

void march(const float* slowness, int rows, int columns, const std::vector<Seed>& seeds, const Stop& stop,
           const Former& former, float* result) {
  static thread_local std::vector<Node> nodes;
  March march(slowness, rows, columns, nodes);
  if (former.cost != nullptr) march.take_over(former);
  for (const Seed& seed : seeds) march.seed(seed);
  march.run(stop);
  march.write(result);
}

std::vector<std::pair<int, int>> descend(const float* cost, int rows, int columns, int row, int column, int most) {
  std::vector<std::pair<int, int>> cells;
  const auto at = [&](int r, int c) { return cost[static_cast<std::size_t>(r) * columns + c]; };
  while (static_cast<int>(cells.size()) < most) {
    cells.push_back({row, column});
    std::pair<int, int> best{row, column};
    for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c) {
        if (at(r, c) < at(best.first, best.second)) best = {r, c};
      }
    }
    if (best == std::make_pair(row, column)) break;
    std::tie(row, column) = best;
  }
  return cells;
}

}  // namespace mr_sim::navigation
