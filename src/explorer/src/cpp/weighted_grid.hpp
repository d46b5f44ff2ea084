// Shortest paths over the cells of a weighted grid with 8 neighbours a cell.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace explorer {

using Cell = std::pair<int, int>;  // row, column

// A step between two neighbours costs its length in metres times the mean of their weights.
class WeightedGrid {
 public:
  // `weights`: rows * columns, positive, infinite where there is no way. `resolution`: edge of a cell in metres.
  WeightedGrid(const float* weights, int rows, int columns, double resolution);

  int rows() const { return rows_; }
  int columns() const { return columns_; }

  // Cost in metres from a cell to each cell (rows * columns) into `costs`, infinite where no path leads.
  void costs_from(const Cell& start, double* costs) const;

  // The cheapest path to a cell with a finite cost, from the start of `costs` on.
  std::vector<Cell> path_to(const Cell& end, const double* costs) const;

  // Costs in metres between each two of n cells (n * n), symmetric, infinite where no path leads.
  std::vector<double> costs_between(const std::vector<Cell>& cells) const;

 private:
  class Search;

  bool contains(const Cell& cell) const;
  std::size_t index_of(const Cell& cell) const;  // throws std::out_of_range

  int rows_, columns_;
  std::ptrdiff_t stride_;
  double resolution_;
  float straight_, diagonal_;   // half the length of a step in metres
  std::vector<float> weights_;  // with a border of infinite weight, so that no neighbour lies outside
  float least_, greatest_;      // finite weight
};

}  // namespace explorer
