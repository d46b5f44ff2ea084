// Poses of nodes by least squares over transforms between them; see pose_graph.py.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace map_merger {

// A transform (x, y in m, yaw in rad) that maps the frame of the second node to that of the first.
struct Link {
  std::size_t first, second;
  Eigen::Vector3d mean;
  Eigen::Matrix3d covariance;
};

struct Solution {
  std::vector<Eigen::Vector3d> poses;
  Eigen::MatrixXd covariance;  // 3 rows and columns for each node, zero for those that are held
};

// Gauss-Newton from the poses on, at most `steps`, until no value changes by `small_step`. Held nodes stay. Each node
// hangs together with a held one. Throws std::invalid_argument if the links leave something open.
Solution solved(const std::vector<Link>& links, std::vector<Eigen::Vector3d> poses, const std::vector<bool>& held,
                int steps, double small_step);

// Distance of each link from the solution in standard deviations. in_solution: of links that helped to find the
// solution the covariance is their own, of others that of the solution as well.
std::vector<double> gaps_of(const std::vector<Link>& links, const std::vector<bool>& in_solution,
                            const Solution& solution);

}  // namespace map_merger
