// Python module mr_robot._slam.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <tuple>

#include "slam.hpp"
#include "square_walls.hpp"

namespace py = pybind11;
using namespace mr_robot::slam;

namespace {

using PoseTuple = std::tuple<double, double, double>;
using Ranges = py::array_t<float, py::array::c_style | py::array::forcecast>;

Pose to_pose(const PoseTuple& pose) { return {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)}; }
PoseTuple to_tuple(const Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

SlamOptions slam_options(double surface_deviation, double free_radius, double small_object_size, double resolution,
                         double match_distance, double match_angle, double insert_distance, double insert_angle,
                         double insert_interval, double search_window, double surface_window, double free_range) {
  SlamOptions options{{free_radius, small_object_size}, {surface_deviation}, {small_object_size}};
  options.grid.resolution = resolution;
  options.match.window = search_window;
  options.scan.surface_window = surface_window;
  options.scan.free_range = free_range;
  options.match_distance = match_distance;
  options.match_angle = match_angle;
  options.insert_distance = insert_distance;
  options.insert_angle = insert_angle;
  options.insert_interval = insert_interval;
  return options;
}

py::tuple process(Slam& slam, const Ranges& ranges, const PoseTuple& odometry, const PoseTuple& mount, double angle_min,
                  double angle_increment, double range_min, double range_max, double time, const PoseTuple& swept) {
  const LaserGeometry geometry{angle_min, angle_increment, range_min, range_max, to_pose(mount), to_pose(swept)};
  const SlamUpdate update =
      slam.process(ranges.data(), static_cast<std::size_t>(ranges.size()), geometry, to_pose(odometry), time);
  return py::make_tuple(to_tuple(update.pose), update.matched, update.inserted, update.share);
}

// Cells and, in cells, the lower left corner of the grid.
py::tuple occupancy(const Slam& slam) {
  const GridMap& map = slam.map();
  const std::vector<int8_t> cells = map.occupancy();
  py::array_t<int8_t> grid({map.height(), map.width()});
  std::copy(cells.begin(), cells.end(), grid.mutable_data());
  return py::make_tuple(grid, map.origin().x, map.origin().y);
}

// Rows (x, y, normal x, normal y, hits).
py::array_t<float> surfaces(const Slam& slam) {
  const GridMap& map = slam.map();
  std::vector<float> values;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const Surface* surface = map.surface({map.origin().x + x, map.origin().y + y});
      if (surface == nullptr) continue;
      values.insert(values.end(), {surface->x, surface->y, surface->normal_x, surface->normal_y, surface->hits});
    }
  }
  py::array_t<float> rows({static_cast<py::ssize_t>(values.size() / 5), py::ssize_t{5}});
  std::copy(values.begin(), values.end(), rows.mutable_data());
  return rows;
}

// Rows (x, y, off x, off y, normal x, normal y, deviation).
py::array_t<double> edges(const Ranges& ranges, const PoseTuple& mount, double angle_min, double angle_increment,
                          double range_min, double range_max, double small_object_size) {
  const LaserGeometry geometry{angle_min, angle_increment, range_min, range_max, to_pose(mount), Pose{}};
  const ScanOptions options{small_object_size};
  const auto found =
      edges_of(make_scan(ranges.data(), static_cast<std::size_t>(ranges.size()), geometry, options), small_object_size);
  py::array_t<double> rows({static_cast<py::ssize_t>(found.size()), py::ssize_t{7}});
  double* value = rows.mutable_data();
  for (const Edge& edge : found) {
    for (const double each :
         {edge.place.x, edge.place.y, edge.off.x, edge.off.y, edge.normal.x, edge.normal.y, edge.deviation})
      *value++ = each;
  }
  return rows;
}

}  // namespace

PYBIND11_MODULE(_slam, module) {
  module.doc() = "Core of the SLAM engine. SI units, poses as (x, y, yaw).";
  py::class_<SlamOptions>(module, "SlamOptions")
      .def(py::init(&slam_options), py::kw_only(), py::arg("surface_deviation"), py::arg("free_radius"),
           py::arg("small_object_size"), py::arg("resolution"), py::arg("match_distance"), py::arg("match_angle"),
           py::arg("insert_distance"), py::arg("insert_angle"), py::arg("insert_interval"), py::arg("search_window"),
           py::arg("surface_window"), py::arg("free_range"));
  py::class_<SquareWalls>(module, "SquareWalls")
      .def(py::init<>())
      .def("add",
           [](SquareWalls& walls, const Ranges& ranges, double angle_min, double angle_increment, double range_min,
              double range_max, double yaw, double small_object_size) {
             const LaserGeometry geometry{angle_min, angle_increment, range_min, range_max, Pose{}, Pose{}};
             const auto size = static_cast<std::size_t>(ranges.size());
             walls.add(make_scan(ranges.data(), size, geometry, {small_object_size}), yaw);
           })
      .def("direction", &SquareWalls::direction);
  module.def("edges", &edges, "Ends of surfaces in a scan: rows (x, y, off x, off y, normal x, normal y, deviation).");
  py::class_<PoseGraph>(module, "PoseGraph")
      .def(py::init<>())
      .def("add", [](PoseGraph& graph, const PoseTuple& pose) { graph.add(to_pose(pose)); })
      .def("link_odometry",
           [](PoseGraph& graph, std::size_t next, const PoseTuple& motion, const PoseTuple& deviation) {
             graph.link_odometry(next, to_pose(motion), to_pose(deviation));
           })
      .def("link", [](PoseGraph& graph, std::size_t from, std::size_t to, const PoseTuple& relative,
                      const Eigen::Matrix3d& information) { graph.link(from, to, to_pose(relative), information); })
      .def("see_walls", &PoseGraph::see_walls)
      .def("see_edge",
           [](PoseGraph& graph, std::size_t pose, double x, double y, double off_x, double off_y, double normal_x,
              double normal_y, double deviation) {
             graph.see_edge(pose, {{x, y}, {off_x, off_y}, {normal_x, normal_y}, deviation});
           })
      .def("match_edges", &PoseGraph::match_edges)
      .def("direction_of_walls", &PoseGraph::direction_of_walls)
      .def("solve", &PoseGraph::solve, py::arg("iterations") = 8)
      .def("begin", &PoseGraph::begin)
      .def("step", &PoseGraph::step)
      .def("finish", &PoseGraph::finish)
      .def("pose", [](const PoseGraph& graph, std::size_t index) { return to_tuple(graph.pose(index)); });
  py::class_<Slam>(module, "Slam")
      .def(py::init<const SlamOptions&>())
      .def("process", &process, py::arg("ranges"), py::arg("odometry"), py::arg("mount"), py::arg("angle_min"),
           py::arg("angle_increment"), py::arg("range_min"), py::arg("range_max"), py::arg("time"),
           py::arg("swept") = PoseTuple{0.0, 0.0, 0.0})
      .def_property_readonly("reach", &Slam::reach)
      .def("pose_at",
           [](const Slam& slam, const PoseTuple& odometry) { return to_tuple(slam.pose_at(to_pose(odometry))); })
      .def("map_to_odometry", [](const Slam& slam) { return to_tuple(slam.map_to_odometry()); })
      .def_property_readonly("odometry", [](const Slam& slam) { return to_tuple(slam.odometry()); })
      .def("begin_journal", &Slam::begin_journal)
      .def("take_journal", [](Slam& slam) { return py::bytes(slam.take_journal()); })
      .def("state", [](const Slam& slam) { return py::bytes(slam.state()); })
      .def("recall",
           [](Slam& slam, std::string_view written, std::string_view state) { return slam.recall(written, state); })
      .def("occupancy", &occupancy)
      .def("surfaces", &surfaces, "Rows (x, y, normal x, normal y, hits) float32, map frame.");
}
