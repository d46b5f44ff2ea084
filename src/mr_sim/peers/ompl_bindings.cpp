// Python module _ompl_peer: manoeuvres planned by OMPL, to compare navigation with.
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <tuple>

#include "ompl_manoeuvre.hpp"

namespace py = pybind11;
using namespace mr_robot::navigation;

namespace {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Pair = std::pair<double, double>;
using Triple = std::tuple<double, double, double>;

Doubles plan(const Floats& cost, double resolution, const Pair& origin, const Pair& goal, const Triple& pose,
             const Doubles& obstacles, const Footprint& footprint, const Agility& agility, double radius,
             double limit) {
  const Field field{cost.data(),
                    static_cast<int>(cost.shape(0)),
                    static_cast<int>(cost.shape(1)),
                    resolution,
                    origin.first,
                    origin.second,
                    goal.first,
                    goal.second};
  std::vector<Obstacle> points;
  for (py::ssize_t i = 0; i < obstacles.shape(0); ++i) {
    points.push_back({obstacles.at(i, 0), obstacles.at(i, 1), obstacles.at(i, 2), obstacles.at(i, 3)});
  }
  const auto way = navigation_peers::ompl_manoeuvre(field, {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)},
                                                    points, footprint, agility, {radius, limit});
  Doubles rows({static_cast<py::ssize_t>(way.size()), py::ssize_t{5}});
  for (std::size_t i = 0; i < way.size(); ++i) {
    const double row[] = {way[i].x, way[i].y, way[i].yaw, way[i].direction, way[i].seconds};
    std::copy(std::begin(row), std::end(row), rows.mutable_data(static_cast<py::ssize_t>(i), 0));
  }
  return rows;
}

}  // namespace

PYBIND11_MODULE(_ompl_peer, module) {
  module.doc() = "Manoeuvres planned by OMPL. SI units, poses as (x, y, yaw).";
  py::module_::import("mr_robot._navigation");  // Footprint and Agility
  ompl::RNG::setSeed(1);
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  module.def("manoeuvre", &plan, py::arg("cost"), py::arg("resolution"), py::arg("origin"), py::arg("goal"),
             py::arg("pose"), py::arg("obstacles"), py::arg("footprint"), py::arg("agility"), py::arg("radius"),
             py::arg("limit"), "Rows as of mr_robot._navigation.manoeuvre.");
}
