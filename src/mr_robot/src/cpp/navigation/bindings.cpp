// Python module mr_robot._navigation.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <tuple>

#include "manoeuvre.hpp"
#include "march.hpp"
#include "rollout.hpp"
#include "slowness.hpp"
#include "surroundings.hpp"

namespace py = pybind11;
using namespace mr_robot::navigation;

namespace {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Bytes = py::array_t<std::int8_t, py::array::c_style | py::array::forcecast>;
using Cells = std::vector<std::pair<int, int>>;
using Triple = std::tuple<double, double, double>;
using Pair = std::pair<double, double>;

Pose to_pose(const Triple& pose) { return {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)}; }

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

Floats like(const Floats& grid) { return Floats({grid.shape(0), grid.shape(1)}); }

bool same_shape(const py::array& a, const py::array& b) {
  return a.ndim() == 2 && b.ndim() == 2 && a.shape(0) == b.shape(0) && a.shape(1) == b.shape(1);
}

Floats march_grid(const Floats& slowness, const std::vector<std::tuple<int, int, float>>& seeds,
                  std::pair<int, int> stop, float beyond, float limit,
                  const std::optional<std::pair<Floats, Floats>>& former) {
  require(slowness.ndim() == 2, "slowness needs the shape (rows, columns)");
  const int rows = static_cast<int>(slowness.shape(0)), columns = static_cast<int>(slowness.shape(1));
  std::vector<Seed> list;
  for (const auto& [row, column, cost] : seeds) {
    if (row >= 0 && column >= 0 && row < rows && column < columns) list.push_back({row, column, cost});
  }
  Former before;
  if (former) {
    require(same_shape(former->first, slowness) && same_shape(former->second, slowness),
            "a former march needs a grid of the same size");
    before = {former->first.data(), former->second.data()};
  }
  require(stop.first < rows && stop.second < columns && (stop.first < 0 || stop.second >= 0), "no such stop cell");
  Floats result = like(slowness);
  march(slowness.data(), rows, columns, list, {stop.first, stop.second, beyond, limit}, before, result.mutable_data());
  return result;
}

py::tuple inflate_walls(const Bytes& cells, float resolution, const Inflation& inflation, bool unknown_blocks) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  Floats distance({cells.shape(0), cells.shape(1)}), slowness = like(distance);
  inflate(cells.data(), static_cast<int>(cells.shape(0)), static_cast<int>(cells.shape(1)), resolution, inflation,
          unknown_blocks, distance.mutable_data(), slowness.mutable_data());
  return py::make_tuple(distance, slowness);
}

Floats slower_around(const Floats& slowness, const Cells& obstacles, float resolution, const Inflation& inflation) {
  const int rows = static_cast<int>(slowness.shape(0)), columns = static_cast<int>(slowness.shape(1));
  for (const auto& [row, column] : obstacles) {
    require(row >= 0 && column >= 0 && row < rows && column < columns, "an obstacle lies outside the grid");
  }
  Floats result = like(slowness);
  std::copy(slowness.data(), slowness.data() + slowness.size(), result.mutable_data());
  add_obstacles(result.mutable_data(), rows, columns, obstacles, resolution, inflation);
  return result;
}

Cells descend_grid(const Floats& cost, std::pair<int, int> cell, int most) {
  const int rows = static_cast<int>(cost.shape(0)), columns = static_cast<int>(cost.shape(1));
  require(cell.first >= 0 && cell.second >= 0 && cell.first < rows && cell.second < columns, "no such cell");
  return descend(cost.data(), rows, columns, cell.first, cell.second, most);
}

template <typename Value, int flags>
mr_grid::Grid<Value> to_grid(const py::array_t<Value, flags>& values, double resolution, const Pair& origin) {
  return {{values.data(), static_cast<int>(values.shape(0)), static_cast<int>(values.shape(1))},
          resolution,
          {origin.first, origin.second}};
}

// A map that keeps the array it looks at.
struct OwnedMap {
  Bytes cells;
  Map view;
};

OwnedMap own_map(const Bytes& cells, double resolution, const Pair& origin) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  return {cells, to_grid(cells, resolution, origin)};
}

// Walls that keep the arrays they look at.
struct OwnedWalls {
  OwnedMap map;
  Floats distance;
  Walls view;
};

OwnedWalls own_walls(const Bytes& cells, const Floats& distance, double resolution, const Pair& origin) {
  require(same_shape(distance, cells), "cells and distance need the same shape (rows, columns)");
  const OwnedMap map = own_map(cells, resolution, origin);
  return {map, distance, {map.view, distance.data()}};
}

ScanView view_of(const Doubles& points, const Doubles& ranges, double angle_min, double angle_increment,
                 double range_min, const Triple& mount) {
  require(points.ndim() == 2 && points.shape(1) == 2, "points need the shape (n, 2)");
  return {reinterpret_cast<const Point*>(points.data()),
          static_cast<std::size_t>(points.shape(0)),
          ranges.data(),
          static_cast<std::size_t>(ranges.size()),
          angle_min,
          angle_increment,
          range_min,
          to_pose(mount)};
}

std::vector<Remembered> to_remembered(const Doubles& rows) {
  require(rows.ndim() == 2 && rows.shape(1) == 3, "remembered points need the shape (n, 3)");
  const auto* first = reinterpret_cast<const Remembered*>(rows.data());
  return {first, first + rows.shape(0)};
}

// Structs of `width` doubles as rows.
template <typename Row>
Doubles to_rows(const std::vector<Row>& rows) {
  constexpr std::size_t width = sizeof(Row) / sizeof(double);
  Doubles result({rows.size(), width});
  if (!rows.empty())
    std::copy_n(reinterpret_cast<const double*>(rows.data()), rows.size() * width, result.mutable_data());
  return result;
}

std::vector<Obstacle> to_obstacles(const Doubles& rows) {
  require(rows.ndim() == 2 && rows.shape(1) == 4, "obstacles need the shape (n, 4)");
  const auto* first = reinterpret_cast<const Obstacle*>(rows.data());
  return {first, first + rows.shape(0)};
}

Field to_field(const Floats& cost, double resolution, const Pair& origin, const Pair& goal) {
  require(cost.ndim() == 2, "the cost to go needs the shape (rows, columns)");
  return {to_grid(cost, resolution, origin), {goal.first, goal.second}};
}

py::tuple choose_velocity(const Floats& cost, double resolution, const Pair& origin, const Pair& goal,
                          const Triple& pose, const Pair& velocity, const Doubles& obstacles, const Limits& limits,
                          const Footprint& footprint, const Horizon& horizon, double period) {
  const Field field = to_field(cost, resolution, origin, goal);
  const Choice choice = choose(field, to_pose(pose), {velocity.first, velocity.second}, to_obstacles(obstacles), limits,
                               footprint, horizon, period);
  return py::make_tuple(choice.found, choice.velocity.linear, choice.velocity.angular, choice.gained, choice.clearance);
}

}  // namespace

PYBIND11_MODULE(_navigation, module) {
  module.doc() = "Hot loops of the navigation engine. SI units, poses as (x, y, yaw).";
  module.attr("TOUCHING") = kTouching;
  module.attr("PROGRESS") = kProgress;
  module.attr("SLACK") = kSlack;
  module.attr("RAMP") = kRamp;
  py::class_<Limits>(module, "Limits")
      .def(py::init([](double linear, double angular, double linear_acceleration, double angular_acceleration) {
             return Limits{linear, angular, linear_acceleration, angular_acceleration};
           }),
           py::arg("linear"), py::arg("angular"), py::arg("linear_acceleration"), py::arg("angular_acceleration"))
      .def_readwrite("curvature", &Limits::curvature);
  py::class_<Footprint>(module, "Footprint")
      .def(py::init<double, double, double>(), py::arg("half_length"), py::arg("half_width"), py::arg("radius") = 0.0)
      .def(
          "distance",
          [](const Footprint& self, double x, double y) {
            return self.distance({x, y});
          },
          py::arg("x"), py::arg("y"))
      .def_readonly("radius", &Footprint::radius)
      .def_readonly("half_length", &Footprint::half_length)
      .def_readonly("half_width", &Footprint::half_width);
  py::class_<Horizon>(module, "Horizon")
      .def(py::init([](double duration) { return Horizon{duration}; }), py::arg("duration"))
      .def_readwrite("duration", &Horizon::duration)
      .def_readwrite("step", &Horizon::step)
      .def_readwrite("goal_radius", &Horizon::goal_radius)
      .def_readwrite("slack", &Horizon::slack);
  module.def("march", &march_grid, py::arg("slowness"), py::arg("seeds"), py::arg("stop") = std::make_pair(-1, -1),
             py::arg("beyond") = 0.0F, py::arg("limit") = kUnreached, py::arg("former") = py::none(),
             "Cost to go (rows, columns) float32 from seeds (row, column, cost); infinity where unreached. `former`: "
             "slowness and cost of an earlier march from the same seeds.");
  py::class_<Inflation>(module, "Inflation")
      .def(py::init<float, float, float>(), py::arg("least"), py::arg("most"), py::arg("wall_cost"));
  module.def(
      "inflate", &inflate_walls, py::arg("cells"), py::arg("resolution"), py::arg("inflation"),
      py::arg("unknown_blocks"),
      "Metres to the nearest wall, infinity where it makes no difference, and slowness, infinity = blocked; both "
      "float32 (rows, columns).");
  module.def("slower_around", &slower_around, py::arg("slowness"), py::arg("obstacles"), py::arg("resolution"),
             py::arg("inflation"), "A copy, slower around obstacles at cells (row, column).");
  module.def("descend", &descend_grid, py::arg("cost"), py::arg("cell"), py::arg("most"),
             "Cells (row, column) from one cell down the cost to go.");
  py::class_<OwnedMap>(module, "Map")
      .def(py::init(&own_map), py::arg("cells"), py::arg("resolution"), py::arg("origin"));
  py::class_<OwnedWalls>(module, "Walls")
      .def(py::init(&own_walls), py::arg("cells"), py::arg("distance"), py::arg("resolution"), py::arg("origin"))
      .def_property_readonly("resolution", [](const OwnedWalls& walls) { return walls.view.map.resolution; })
      .def_property_readonly("same_surface", [](const OwnedWalls& walls) { return walls.view.same_surface(); });
  py::class_<Memory>(module, "Memory")
      .def(py::init([](double duration, double cell, std::size_t most) {
             return Memory{duration, cell, most};
           }),
           py::arg("duration"), py::arg("cell"), py::arg("most"));
  py::class_<Margins>(module, "Margins")
      .def(py::init([](double wall, double foreign, double obstacle, double moving, double reaction_time) {
             return Margins{wall, foreign, obstacle, moving, reaction_time};
           }),
           py::arg("wall"), py::arg("foreign"), py::arg("obstacle"), py::arg("moving"), py::arg("reaction_time"));
  module.def(
      "hits",
      [](const Doubles& readings, const Doubles& directions, double range_min, double range_max, const Pair& mount) {
        require(readings.ndim() == 1 && directions.ndim() == 2 && directions.shape(0) == readings.size() &&
                    directions.shape(1) == 2,
                "each of the ranges needs a direction");
        Doubles ranges(readings.size());
        std::copy_n(readings.data(), readings.size(), ranges.mutable_data());
        const std::vector<Point> points =
            hits(ranges.mutable_data(), static_cast<std::size_t>(ranges.size()),
                 reinterpret_cast<const Point*>(directions.data()), range_min, range_max, {mount.first, mount.second});
        return py::make_tuple(ranges, to_rows(points));
      },
      py::arg("ranges"), py::arg("directions"), py::arg("range_min"), py::arg("range_max"), py::arg("mount"),
      "Ranges, float64 (m,), 0 where there is no valid reading, and hits in the robot's frame, float64 (n, 2).");
  module.def(
      "remember",
      [](const Doubles& old, const Doubles& points, const Doubles& ranges, double angle_min, double angle_increment,
         double range_min, const Triple& mount, const Triple& pose, const OwnedWalls& walls, const Memory& memory,
         double now) {
        const ScanView scan = view_of(points, ranges, angle_min, angle_increment, range_min, mount);
        return to_rows(remember(to_remembered(old), scan, to_pose(pose), walls.view, memory, now));
      },
      py::arg("old"), py::arg("points"), py::arg("ranges"), py::arg("angle_min"), py::arg("angle_increment"),
      py::arg("range_min"), py::arg("mount"), py::arg("pose"), py::arg("walls"), py::arg("memory"), py::arg("now"),
      "Remembered points, rows (x, y, time seen), after one more scan.");
  module.def(
      "surroundings",
      [](const Doubles& points, const Triple& pose, const Doubles& remembered, const OwnedWalls& walls,
         const OwnedMap* own, const Footprint& footprint, const Margins& margins, double reach, const Doubles& ranges,
         double angle_min, double angle_increment, const Triple& mount) {
        const ScanView scan = view_of(points, ranges, angle_min, angle_increment, 0.0, mount);
        return to_rows(surroundings(scan, to_pose(pose), to_remembered(remembered), walls.view,
                                    own == nullptr ? nullptr : &own->view, footprint, margins, reach));
      },
      py::arg("points"), py::arg("pose"), py::arg("remembered"), py::arg("walls"), py::arg("own"), py::arg("footprint"),
      py::arg("margins"), py::arg("reach"), py::arg("ranges") = Doubles(0), py::arg("angle_min") = 0.0,
      py::arg("angle_increment") = 1.0, py::arg("mount") = Triple(0.0, 0.0, 0.0),
      "Obstacles near the robot, rows (x, y, margin, reaction time).");
  module.def(
      "outside",
      [](const Triple& pose, const Doubles& obstacles, const Footprint& footprint) {
        return to_rows(outside(to_obstacles(obstacles), to_pose(pose), footprint));
      },
      py::arg("pose"), py::arg("obstacles"), py::arg("footprint"),
      "Of obstacles (n, 4) those that are not inside the body.");
  module.def("choose_velocity", &choose_velocity, py::arg("cost"), py::arg("resolution"), py::arg("origin"),
             py::arg("goal"), py::arg("pose"), py::arg("velocity"), py::arg("obstacles"), py::arg("limits"),
             py::arg("footprint"), py::arg("horizon"), py::arg("period"),
             "(found, linear, angular, seconds gained, clearance).");
  py::class_<Agility>(module, "Agility")
      .def(py::init<const Limits&>(), py::arg("limits"))
      .def_readonly("linear", &Agility::linear);
  module.def(
      "manoeuvre",
      [](const Floats& cost, const Bytes& cells, double resolution, const Pair& origin, const Pair& goal,
         const Triple& pose, const Doubles& obstacles, const Footprint& footprint, const Agility& agility, double known,
         double slack) {
        require(same_shape(cells, cost), "cells and cost need the same shape (rows, columns)");
        const Field field = to_field(cost, resolution, origin, goal);
        const OwnedMap map = own_map(cells, resolution, origin);
        return to_rows(
            manoeuvre(field, map.view, to_pose(pose), to_obstacles(obstacles), footprint, agility, known, slack));
      },
      py::arg("cost"), py::arg("cells"), py::arg("resolution"), py::arg("origin"), py::arg("goal"), py::arg("pose"),
      py::arg("obstacles"), py::arg("footprint"), py::arg("agility"), py::arg("known"), py::arg("slack") = kSlack,
      "Rows (x, y, yaw, direction, seconds), the first the present pose.");
  module.def(
      "turn_wanted",
      [](const Floats& cost, double resolution, const Pair& origin, const Pair& goal, const Triple& pose) {
        const Field field = to_field(cost, resolution, origin, goal);
        const Pose at = to_pose(pose);
        const auto direction = downhill(field, at.x, at.y);
        return direction ? mr_grid::normalized(*direction - at.yaw) : 0.0;
      },
      py::arg("cost"), py::arg("resolution"), py::arg("origin"), py::arg("goal"), py::arg("pose"),
      "rad from the heading to where the cost to go falls.");
  module.def(
      "has_room_to_turn",
      [](const Triple& pose, const Doubles& obstacles, const Footprint& footprint) {
        return has_room_to_turn(to_pose(pose), to_obstacles(obstacles), footprint);
      },
      py::arg("pose"), py::arg("obstacles"), py::arg("footprint"));
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
