#include "obstacles.hpp"

#include <algorithm>

namespace map_merger {
namespace {

std::vector<Run> runs_of(const Mask& walls) {
  std::vector<Run> runs;
  for_each(walls, [&](std::int64_t row, std::int64_t column) {
    if (!runs.empty() && runs.back().row == row && runs.back().right == column) {
      ++runs.back().right;
    } else {
      runs.push_back({row, column, column + 1, runs.size()});
    }
  });
  return runs;
}

// Until the runs are numbered, `obstacle` is another run of the same obstacle; the first one names itself.
std::size_t first_of(std::vector<Run>& runs, std::size_t run) {
  while (runs[run].obstacle != run) run = runs[run].obstacle = runs[runs[run].obstacle].obstacle;
  return run;
}

void join(std::vector<Run>& runs, std::size_t one, std::size_t other) {
  one = first_of(runs, one), other = first_of(runs, other);
  runs[std::max(one, other)].obstacle = std::min(one, other);
}

void join_neighbours(std::vector<Run>& runs) {
  std::size_t above = 0;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    while (runs[above].row + 1 < runs[run].row) ++above;
    while (runs[above].row + 1 == runs[run].row && runs[above].right < runs[run].left) ++above;
    for (std::size_t other = above; runs[other].row + 1 == runs[run].row && runs[other].left <= runs[run].right;
         ++other) {
      join(runs, run, other);
    }
  }
}

void take(Obstacle& obstacle, const Run& run) {
  const std::int64_t length = run.right - run.left;
  obstacle.bottom = run.row + 1;
  obstacle.left = std::min(obstacle.left, run.left);
  obstacle.right = std::max(obstacle.right, run.right);
  obstacle.area += length;
  obstacle.rows += run.row * length;
  obstacle.columns += (run.left + run.right - 1) * length / 2;
}

}  // namespace

Obstacles obstacles_of(const Mask& walls) {
  Obstacles found{runs_of(walls), {}};
  join_neighbours(found.runs);
  for (std::size_t i = 0; i < found.runs.size(); ++i) {
    // The first run of an obstacle comes before its others and is numbered by then.
    Run& run = found.runs[i];
    if (run.obstacle == i) {
      run.obstacle = found.all.size();
      found.all.push_back({run.row, run.left, run.row + 1, run.right});
    } else {
      run.obstacle = found.runs[run.obstacle].obstacle;
    }
    take(found.all[run.obstacle], run);
  }
  return found;
}

}  // namespace map_merger
