#include "graph_bindings.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <vector>

#include "pose_graph.hpp"
#include "require.hpp"

namespace py = pybind11;

namespace map_merger {
namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Numbers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using Flags = py::array_t<bool, py::array::c_style | py::array::forcecast>;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

std::vector<Link> to_links(const Numbers& first, const Numbers& second, const Doubles& mean, const Doubles& covariance,
                           py::ssize_t nodes) {
  const py::ssize_t count = first.size();
  require(first.ndim() == 1 && second.ndim() == 1 && second.size() == count && mean.ndim() == 2 &&
              mean.shape(0) == count && mean.shape(1) == 3 && covariance.ndim() == 3 && covariance.shape(0) == count &&
              covariance.shape(1) == 3 && covariance.shape(2) == 3,
          "links need the shapes (m,), (m,), (m, 3) and (m, 3, 3)");
  std::vector<Link> links;
  for (py::ssize_t i = 0; i < count; ++i) {
    const std::int64_t from = first.at(i), to = second.at(i);
    require(from >= 0 && to >= 0 && from < nodes && to < nodes, "a link is between two of the nodes");
    links.push_back({static_cast<std::size_t>(from), static_cast<std::size_t>(to),
                     Eigen::Map<const Eigen::Vector3d>(mean.data() + 3 * i),
                     Eigen::Map<const RowMajor>(covariance.data() + 9 * i)});
  }
  return links;
}

std::vector<Eigen::Vector3d> to_poses(const Doubles& poses) {
  require(poses.ndim() == 2 && poses.shape(1) == 3, "poses need the shape (n, 3)");
  std::vector<Eigen::Vector3d> result;
  for (py::ssize_t i = 0; i < poses.shape(0); ++i)
    result.emplace_back(Eigen::Map<const Eigen::Vector3d>(poses.data() + 3 * i));
  return result;
}

std::vector<bool> to_flags(const Flags& flags, py::ssize_t count) {
  require(flags.ndim() == 1 && flags.size() == count, "a flag is needed for each");
  return std::vector<bool>(flags.data(), flags.data() + flags.size());
}

py::tuple solve(const Numbers& first, const Numbers& second, const Doubles& mean, const Doubles& covariance,
                const Doubles& start, const Flags& held, int steps, double small_step) {
  const py::ssize_t nodes = start.shape(0);
  const std::vector<Link> links = to_links(first, second, mean, covariance, nodes);
  const Solution solution = solved(links, to_poses(start), to_flags(held, nodes), steps, small_step);
  Doubles poses({nodes, py::ssize_t{3}}), spread({nodes, nodes, py::ssize_t{3}, py::ssize_t{3}});
  for (py::ssize_t i = 0; i < nodes; ++i) {
    Eigen::Map<Eigen::Vector3d>(poses.mutable_data() + 3 * i) = solution.poses[static_cast<std::size_t>(i)];
    for (py::ssize_t j = 0; j < nodes; ++j)
      Eigen::Map<RowMajor>(spread.mutable_data(i, j)) = solution.covariance.block<3, 3>(3 * i, 3 * j);
  }
  return py::make_tuple(poses, spread);
}

std::vector<double> gaps(const Numbers& first, const Numbers& second, const Doubles& mean, const Doubles& covariance,
                         const Flags& in_solution, const Doubles& poses, const Doubles& spread) {
  const py::ssize_t nodes = poses.shape(0);
  require(spread.ndim() == 4 && spread.shape(0) == nodes && spread.shape(1) == nodes && spread.shape(2) == 3 &&
              spread.shape(3) == 3,
          "covariances of poses need the shape (n, n, 3, 3)");
  Solution solution{to_poses(poses), Eigen::MatrixXd(3 * nodes, 3 * nodes)};
  for (py::ssize_t i = 0; i < nodes; ++i)
    for (py::ssize_t j = 0; j < nodes; ++j)
      solution.covariance.block<3, 3>(3 * i, 3 * j) = Eigen::Map<const RowMajor>(spread.data(i, j));
  return gaps_of(to_links(first, second, mean, covariance, nodes), to_flags(in_solution, first.size()), solution);
}

}  // namespace

void bind_graph(py::module& module) {
  module.def("solve_poses", &solve, py::arg("first"), py::arg("second"), py::arg("mean"), py::arg("covariance"),
             py::arg("start"), py::arg("held"), py::arg("steps"), py::arg("small_step"),
             "Poses (n, 3) and their covariances (n, n, 3, 3) by least squares over links, (m,), (m,), (m, 3) and (m, "
             "3, 3), from the poses `start` on, (n, 3), of which those `held`, bool (n,), stay. ValueError if the "
             "links leave a pose open.");
  module.def("pose_gaps", &gaps, py::arg("first"), py::arg("second"), py::arg("mean"), py::arg("covariance"),
             py::arg("in_solution"), py::arg("poses"), py::arg("pose_covariance"),
             "For each link, (m,), its distance from the poses in standard deviations. in_solution: bool (m,), whether "
             "it helped to find the poses.");
}

}  // namespace map_merger
