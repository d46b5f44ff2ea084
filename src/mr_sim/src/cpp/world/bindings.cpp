// Python module mr_sim._world: the world engine's core.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>

#include "world.hpp"

namespace py = pybind11;
using namespace mr_sim;

namespace {

using Cells = py::array_t<uint8_t, py::array::c_style | py::array::forcecast>;
using PoseTuple = std::tuple<double, double, double>;

Pose to_pose(const PoseTuple& pose) { return {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)}; }

OdometryError to_error(const PoseTuple& error) { return {std::get<0>(error), std::get<1>(error), std::get<2>(error)}; }

using Intensities = py::array_t<float, py::array::c_style | py::array::forcecast>;

std::shared_ptr<Raster> make_raster(const Cells& cells, double resolution, std::pair<double, double> origin,
                                    const std::optional<Intensities>& intensities) {
  if (cells.ndim() != 2) throw std::invalid_argument("a raster needs a two-dimensional array");
  if (intensities && intensities->size() != cells.size()) throw std::invalid_argument("one intensity for each cell");
  return std::make_shared<Raster>(cells.data(), static_cast<int>(cells.shape(0)), static_cast<int>(cells.shape(1)),
                                  resolution, Point{origin.first, origin.second},
                                  intensities ? intensities->data() : nullptr);
}

Ranger make_ranger(const PoseTuple& mount, double range_max, double field_of_view, int samples, double noise_variance,
                   double noise_share, double noise_bearing) {
  return {to_pose(mount), range_max, field_of_view, samples, noise_variance, noise_share, noise_bearing};
}

using Points = std::vector<std::vector<std::pair<double, double>>>;

std::vector<Polygon> to_polygons(const Points& points) {
  std::vector<Polygon> polygons;
  for (const auto& corners : points) {
    Polygon& polygon = polygons.emplace_back();
    for (const auto& [x, y] : corners) polygon.push_back({x, y});
  }
  return polygons;
}

int add_robot(World& world, const PoseTuple& start, const Points& footprint, const Points& seen,
              const std::vector<float>& intensities, std::pair<double, double> linear_bounds,
              std::pair<double, double> lateral_bounds, std::pair<double, double> angular_bounds,
              const PoseTuple& localization_origin, bool exact_localization, const PoseTuple& bias,
              const PoseTuple& walk, uint64_t walk_seed, int base_steps, double command_timeout, bool solid,
              uint64_t noise_seed, const std::vector<Ranger>& rangers) {
  RobotOptions options{to_pose(start),
                       to_polygons(footprint),
                       to_polygons(seen),
                       intensities,
                       linear_bounds.first,
                       linear_bounds.second,
                       lateral_bounds.first,
                       lateral_bounds.second,
                       angular_bounds.first,
                       angular_bounds.second,
                       to_pose(localization_origin),
                       exact_localization,
                       to_error(bias),
                       to_error(walk),
                       walk_seed,
                       base_steps,
                       command_timeout,
                       solid,
                       noise_seed,
                       rangers};
  return world.add_robot(std::move(options));
}

py::array_t<RobotState> states(const World& world) {
  py::array_t<RobotState> records(world.size());
  RobotState* record = records.mutable_data();
  for (int i = 0; i < world.size(); ++i) record[i] = world.state(i);
  return records;
}

py::array_t<float> scan(World& world, int robot, int ranger) {
  py::array_t<float> ranges(world.samples(robot, ranger));
  world.scan(robot, ranger, ranges.mutable_data());
  return ranges;
}

std::pair<py::array_t<float>, py::array_t<float>> scan_with_intensities(World& world, int robot, int ranger) {
  py::array_t<float> ranges(world.samples(robot, ranger));
  py::array_t<float> intensities(world.samples(robot, ranger));
  world.scan(robot, ranger, ranges.mutable_data(), intensities.mutable_data());
  return {ranges, intensities};
}

py::array_t<double> cast(const Raster& raster, std::pair<double, double> origin,
                         const py::array_t<double, py::array::c_style | py::array::forcecast>& angles,
                         double max_range) {
  py::array_t<double> ranges(angles.size());
  for (py::ssize_t i = 0; i < angles.size(); ++i) {
    const double angle = angles.data()[i];
    ranges.mutable_data()[i] =
        raster.cast({origin.first, origin.second}, {std::cos(angle), std::sin(angle)}, max_range);
  }
  return ranges;
}

}  // namespace

PYBIND11_MODULE(_world, module) {
  module.doc() = "Core of the world engine: raster of walls, ray casting, robots. SI units, angles in radians.";
  PYBIND11_NUMPY_DTYPE(RobotState, odometry_x, odometry_y, odometry_yaw, linear, lateral, angular, x, y, yaw,
                       velocity_x, velocity_y, velocity_yaw, stalled, contact);

  py::class_<Raster, std::shared_ptr<Raster>>(module, "Raster")
      .def(py::init(&make_raster), py::arg("cells"), py::arg("resolution"), py::arg("origin"),
           py::arg("intensities") = py::none())
      .def("cast", &cast, py::arg("origin"), py::arg("angles"), py::arg("max_range"),
           "Ranges in metres from `origin` along the world angles (any shape, flattened).")
      .def("touches", [](const Raster& raster, std::pair<double, double> a, std::pair<double, double> b) {
        return raster.touches({a.first, a.second}, {b.first, b.second});
      });

  py::class_<Ranger>(module, "Ranger")
      .def(py::init(&make_ranger), py::arg("mount"), py::arg("range_max"), py::arg("field_of_view"), py::arg("samples"),
           py::arg("noise_variance"), py::arg("noise_share"), py::arg("noise_bearing") = 0.0);

  py::class_<World>(module, "World")
      .def(py::init([](std::shared_ptr<Raster> obstacles, std::shared_ptr<Raster> visible, double interval) {
             return std::make_unique<World>(std::move(obstacles), std::move(visible), interval);
           }),
           py::arg("obstacles"), py::arg("visible"), py::arg("interval"))
      .def("add_robot", &add_robot, py::kw_only(), py::arg("start"), py::arg("footprint"), py::arg("seen"),
           py::arg("intensities"), py::arg("linear_bounds"), py::arg("lateral_bounds"), py::arg("angular_bounds"),
           py::arg("localization_origin"), py::arg("exact_localization"), py::arg("bias"), py::arg("walk"),
           py::arg("walk_seed"), py::arg("base_steps"), py::arg("command_timeout"), py::arg("solid"),
           py::arg("noise_seed"), py::arg("rangers"))
      .def("command", &World::command, py::arg("robot"), py::arg("linear"), py::arg("lateral"), py::arg("angular"))
      .def("reset_positions", &World::reset_positions)
      .def("step", &World::step)
      .def_property_readonly("time", &World::time)
      .def_property_readonly("steps", &World::steps)
      .def("states", &states, "One NumPy record per robot, in the order they were added.")
      .def("contact_at", [](const World& world, int robot,
                            const PoseTuple& pose) { return static_cast<int>(world.contact_at(robot, to_pose(pose))); })
      .def("scan", &scan, py::arg("robot"), py::arg("ranger"), "Ranges in metres, float32, counter-clockwise.")
      .def("scan_with_intensities", &scan_with_intensities, py::arg("robot"), py::arg("ranger"),
           "Ranges as of `scan`, and as many intensities of the echoes, 0 without one.");
}
