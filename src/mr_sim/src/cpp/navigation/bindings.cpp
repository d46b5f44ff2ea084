// Python module mr_sim._navigation.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <tuple>

#include "march.hpp"
#include "rollout.hpp"

namespace py = pybind11;
using namespace mr_sim::navigation;

namespace {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Triple = std::tuple<double, double, double>;
using Pair = std::pair<double, double>;

Floats march_grid(const Floats& slowness, const std::vector<std::tuple<int, int, float>>& seeds,
                  std::pair<int, int> stop, float beyond, float limit) {
  const int rows = static_cast<int>(slowness.shape(0)), columns = static_cast<int>(slowness.shape(1));
  std::vector<Seed> list;
  for (const auto& [row, column, cost] : seeds) {
    if (row >= 0 && column >= 0 && row < rows && column < columns) list.push_back({row, column, cost});
  }
  const std::vector<float> cost = march(slowness.data(), rows, columns, list, stop.first, stop.second, beyond, limit);
  Floats result({rows, columns});
  std::copy(cost.begin(), cost.end(), result.mutable_data());
  return result;
}

Pose to_pose(const Triple& pose) { return {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)}; }

std::vector<Obstacle> to_obstacles(const Doubles& rows) {
  if (rows.ndim() != 2 || rows.shape(1) != 4) throw std::invalid_argument("obstacles need the shape (n, 4)");
  std::vector<Obstacle> obstacles;
  const auto view = rows.unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    obstacles.push_back({view(i, 0), view(i, 1), view(i, 2), view(i, 3)});
  }
  return obstacles;
}

py::tuple choose_velocity(const Floats& cost, double resolution, const Pair& origin, const Pair& goal,
                          const Triple& pose, const Pair& velocity, const Doubles& obstacles, const Limits& limits,
                          const Footprint& footprint, const Horizon& horizon, double period) {
  const Field field{cost.data(),
                    static_cast<int>(cost.shape(0)),
                    static_cast<int>(cost.shape(1)),
                    resolution,
                    origin.first,
                    origin.second,
                    goal.first,
                    goal.second};
  const Choice choice = choose(field, to_pose(pose), {velocity.first, velocity.second}, to_obstacles(obstacles), limits,
                               footprint, horizon, period);
  return py::make_tuple(choice.found, choice.velocity.linear, choice.velocity.angular, choice.time, choice.clearance);
}

}  // namespace

PYBIND11_MODULE(_navigation, module) {
  module.doc() = "Hot loops of the navigation engine. SI units, poses as (x, y, yaw).";
  py::class_<Limits>(module, "Limits")
      .def(py::init<>())
      .def_readwrite("linear", &Limits::linear)
      .def_readwrite("reverse", &Limits::reverse)
      .def_readwrite("angular", &Limits::angular)
      .def_readwrite("linear_acceleration", &Limits::linear_acceleration)
      .def_readwrite("angular_acceleration", &Limits::angular_acceleration);
  py::class_<Footprint>(module, "Footprint")
      .def(py::init<>())
      .def_readwrite("half_length", &Footprint::half_length)
      .def_readwrite("half_width", &Footprint::half_width);
  py::class_<Horizon>(module, "Horizon")
      .def(py::init<>())
      .def_readwrite("duration", &Horizon::duration)
      .def_readwrite("step", &Horizon::step)
      .def_readwrite("goal_radius", &Horizon::goal_radius)
      .def_readwrite("heading_weight", &Horizon::heading_weight);
  module.def("march", &march_grid, py::arg("slowness"), py::arg("seeds"), py::arg("stop") = std::make_pair(-1, -1),
             py::arg("beyond") = 0.0F, py::arg("limit") = kUnreached,
             "Cost to go (rows, columns) float32 from seeds (row, column, cost); infinity where unreached.");
  module.def("choose_velocity", &choose_velocity, py::arg("cost"), py::arg("resolution"), py::arg("origin"),
             py::arg("goal"), py::arg("pose"), py::arg("velocity"), py::arg("obstacles"), py::arg("limits"),
             py::arg("footprint"), py::arg("horizon"), py::arg("period"),
             "(found, linear, angular, seconds to the goal, clearance).");
  module.def(
      "is_clear",
      [](const Triple& pose, const Pair& velocity, const Pair& target, const Doubles& obstacles, const Limits& limits,
         const Footprint& footprint, const Horizon& horizon) {
        return is_clear(to_pose(pose), {velocity.first, velocity.second}, {target.first, target.second},
                        to_obstacles(obstacles), limits, footprint, horizon);
      },
      py::arg("pose"), py::arg("velocity"), py::arg("target"), py::arg("obstacles"), py::arg("limits"),
      py::arg("footprint"), py::arg("horizon"));
  module.def(
      "clearance",
      [](const Triple& pose, const Doubles& obstacles, const Footprint& footprint) {
        return clearance(to_pose(pose), 0.0, to_obstacles(obstacles), footprint).bare;
      },
      py::arg("pose"), py::arg("obstacles"), py::arg("footprint"));
}
