#include "march.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>
#include <utility>

namespace mr_robot::navigation {
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

// One march. Its grid has a rim of one blocked cell, so that every cell has four neighbours.
class March {
 public:
  // Memory to work in, kept by the caller because fresh pages cost more than the march itself.
  struct Cells {
    std::vector<float> slowness;
    std::vector<float> cost;   // final, or kUnreached
    std::vector<float> least;  // offered so far; minus infinity where blocked
  };

  March(const float* slowness, int rows, int columns, Cells& cells)
      : rows_(rows), columns_(columns), stride_(columns + 2), cells_(cells) {
    const std::size_t size = static_cast<std::size_t>(rows + 2) * stride_;
    cells_.slowness.resize(size);
    cells_.cost.resize(size);
    cells_.least.resize(size);
    block_row(-1);
    block_row(rows);
    for (int row = 0; row < rows; ++row) {
      const float* from = slowness + plain(row);
      float *cost = &cells_.cost[at(row, 0)], *least = &cells_.least[at(row, 0)];
      std::copy_n(from, columns, &cells_.slowness[at(row, 0)]);
      std::fill_n(cost - 1, stride_, kUnreached);
      for (int c = 0; c < columns; ++c) least[c] = from[c] < kUnreached ? kUnreached : -kUnreached;
      least[-1] = least[columns] = -kUnreached;
    }
  }

  void seed(const Seed& seed) { offer(at(seed.row, seed.column), seed.cost); }

  // Takes over the costs that no change of the slowness can reach, and lets the front begin beside them.
  void take_over(const Former& former) {
    const float bound = changed_from(former);
    std::vector<Span> known(rows_ + 2);  // of each row, with the rim
    for (int row = 0; row < rows_; ++row) {
      const float* from = former.cost + plain(row);
      float *cost = &cells_.cost[at(row, 0)], *least = &cells_.least[at(row, 0)];
      int count = 0;
      for (int c = 0; c < columns_; ++c) {
        const bool holds = from[c] < bound;
        cost[c] = holds ? from[c] : kUnreached;
        least[c] = holds ? from[c] : least[c];
        count += holds;
      }
      if (count > 0) known[row + 1] = final_in(cost);
    }
    for (int row = 0; row < rows_; ++row) {
      const Span near = around(known[row], known[row + 1], known[row + 2]);
      for (int index = at(row, near.begin), end = at(row, near.end); index < end; ++index) {
        if (cells_.least[index] == kUnreached && beside_final(index)) offer(index, upwind(index));
      }
    }
  }

  void run(const Stop& stop) {
    const int goal = stop.row < 0 ? -1 : at(stop.row, stop.column);
    limit_ = stop.limit;
    if (goal >= 0 && cells_.cost[goal] < kUnreached) limit_ = std::min(limit_, cells_.cost[goal] + stop.beyond);
    Front::Cell top;
    while (front_.pop(top)) {
      if (top.cost > limit_) break;
      if (cells_.cost[top.index] < kUnreached) continue;
      cells_.cost[top.index] = top.cost;
      if (top.index == goal) limit_ = std::min(limit_, top.cost + stop.beyond);
      for (const int neighbour : {top.index - stride_, top.index + stride_, top.index - 1, top.index + 1}) {
        // Blocked cells and those with their final cost ask for nothing less.
        if (cells_.least[neighbour] > top.cost) offer(neighbour, upwind(neighbour));
      }
    }
  }

  void write(float* result) const {
    for (int row = 0; row < rows_; ++row) std::copy_n(&cells_.cost[at(row, 0)], columns_, result + plain(row));
  }

 private:
  // Columns from `begin` up to but without `end`.
  struct Span {
    int begin = 0, end = 0;
  };

  int at(int row, int column) const { return (row + 1) * stride_ + column + 1; }
  // Where a row begins in a grid without rim.
  std::size_t plain(int row) const { return static_cast<std::size_t>(row) * columns_; }

  void block_row(int row) {
    std::fill_n(&cells_.cost[at(row, -1)], stride_, kUnreached);
    std::fill_n(&cells_.least[at(row, -1)], stride_, -kUnreached);
  }

  // The span of the final costs of a row that has some.
  Span final_in(const float* cost) const {
    Span span{0, columns_};
    while (cost[span.begin] == kUnreached) ++span.begin;
    while (cost[span.end - 1] == kUnreached) --span.end;
    return span;
  }

  // The columns of the middle row that may have a neighbour in one of the spans.
  Span around(const Span& above, const Span& middle, const Span& below) const {
    Span all{columns_, 0};
    for (const Span& span : {above, middle, below}) {
      if (span.begin == span.end) continue;
      all = {std::min(all.begin, span.begin - 1), std::max(all.end, span.end + 1)};
    }
    return all.begin < all.end ? Span{std::max(0, all.begin), std::min(columns_, all.end)} : Span{};
  }

  float beside(int index) const { return std::min(cells_.cost[index - 1], cells_.cost[index + 1]); }
  float above_or_below(int index) const { return std::min(cells_.cost[index - stride_], cells_.cost[index + stride_]); }

  // Of a cell beside one with a final cost.
  float upwind(int index) const { return solve(above_or_below(index), beside(index), cells_.slowness[index]); }

  bool beside_final(int index) const { return std::min(above_or_below(index), beside(index)) < kUnreached; }

  void offer(int index, float cost) {
    if (!(cost < cells_.least[index]) || cost > limit_) return;
    cells_.least[index] = cost;
    front_.push(cost, index);
  }

  // The least cost that a cell of another slowness, now or formerly, can have: its own or that of a neighbour.
  float changed_from(const Former& former) const {
    float bound = kUnreached;
    for (int row = 0; row < rows_; ++row) {
      const float *now = &cells_.slowness[at(row, 0)], *then = former.slowness + plain(row);
      if (std::memcmp(now, then, columns_ * sizeof(float)) == 0) continue;
      const float* cost = former.cost + plain(row);
      for (int c = 0; c < columns_; ++c) {
        if (now[c] == then[c]) continue;
        bound = std::min(bound, cost[c]);
        if (row > 0) bound = std::min(bound, cost[c - columns_]);
        if (row + 1 < rows_) bound = std::min(bound, cost[c + columns_]);
        if (c > 0) bound = std::min(bound, cost[c - 1]);
        if (c + 1 < columns_) bound = std::min(bound, cost[c + 1]);
      }
    }
    return bound;
  }

  int rows_, columns_, stride_;
  Cells& cells_;
  Front front_;
  float limit_ = kUnreached;
};

}  // namespace

void march(const float* slowness, int rows, int columns, const std::vector<Seed>& seeds, const Stop& stop,
           const Former& former, float* result) {
  static thread_local March::Cells cells;
  March march(slowness, rows, columns, cells);
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

}  // namespace mr_robot::navigation
