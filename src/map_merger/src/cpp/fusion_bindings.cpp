#include "fusion_bindings.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "cell_values.hpp"
#include "ghosts.hpp"
#include "require.hpp"
#include "weighing.hpp"

namespace py = pybind11;

namespace map_merger {
namespace {

using MapCells = py::array_t<std::int8_t, py::array::c_style>;
using Places = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using Corners = std::array<std::int64_t, 4>;

Known to_known(const MapCells& cells) { return known_of(cells.data(), cells.shape(0), cells.shape(1)); }

std::vector<Known> to_known(const std::vector<MapCells>& maps) {
  std::vector<Known> known;
  for (const MapCells& cells : maps) {
    require(cells.ndim() == 2, "cells need the shape (rows, columns)");
    require(cells.shape(0) == maps[0].shape(0) && cells.shape(1) == maps[0].shape(1), "maps are of one shape");
    known.push_back(to_known(cells));
  }
  return known;
}

void fill(MapCells& cells, const Mask& mask, std::int8_t value) {
  std::int8_t* first = cells.mutable_data();
  const std::int64_t columns = mask.columns();
  for_each(mask, [&](std::int64_t row, std::int64_t column) { first[row * columns + column] = value; });
}

MapCells copy_of(const MapCells& cells) {
  MapCells copy({cells.shape(0), cells.shape(1)});
  std::copy_n(cells.data(), cells.size(), copy.mutable_data());
  return copy;
}

MapCells weighed_cells(const std::vector<MapCells>& maps, bool locked, std::int64_t same_wall,
                       std::int64_t seen_through) {
  require(!maps.empty(), "there is a map at least");
  require(same_wall >= 1 && same_wall < 64 && seen_through >= 1 && seen_through < 64, "tolerances are 1 to 63 cells");
  const std::vector<Known> known = to_known(maps);
  Known result = weighed(known, locked, {same_wall, seen_through});
  MapCells cells = copy_of(maps.front());
  if (locked) {
    result.wall.remove(known.front().wall);
    result.floor.remove(known.front().floor);
  } else {
    std::fill_n(cells.mutable_data(), cells.size(), kUnknown);
  }
  fill(cells, result.wall, kOccupied);
  fill(cells, result.floor, kFree);
  return cells;
}

std::vector<Place> to_places(const Places& places) {
  require(places.ndim() == 2 && places.shape(1) == 2, "places need the shape (n, 2)");
  std::vector<Place> result(static_cast<std::size_t>(places.shape(0)));
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = {places.data()[2 * i], places.data()[2 * i + 1]};
  return result;
}

std::vector<std::optional<MapCells>> without_ghosts(const std::vector<MapCells>& maps,
                                                    const std::vector<std::pair<int, Places>>& tracks,
                                                    const Corners& box, const GhostRules& rules) {
  const std::vector<Known> known = to_known(maps);
  const Window window{box[0], box[1], box[2], box[3]};
  std::vector<Robot> robots;
  for (const auto& [map, places] : tracks) {
    require(map < static_cast<int>(maps.size()), "a robot's map is one of the maps");
    Robot robot{presence_of(to_places(places), window, rules), std::nullopt};
    if (map >= 0) robot.map = static_cast<std::size_t>(map);
    if (robot.presence.near.any()) robots.push_back(std::move(robot));
  }
  std::vector<std::optional<MapCells>> cleaned(maps.size());
  if (robots.empty()) return cleaned;
  const std::vector<Mask> ghosts = ghosts_of(known, robots, rules);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (!ghosts[i].any()) continue;
    cleaned[i] = copy_of(maps[i]);
    fill(*cleaned[i], ghosts[i], kFree);
  }
  return cleaned;
}

bool may_be_ghost(const MapCells& cells, const Places& places, const Corners& box, const GhostRules& rules) {
  require(cells.ndim() == 2, "cells need the shape (rows, columns)");
  const Window window{box[0], box[1], box[2], box[3]};
  require(cells.shape(0) == window.bottom - window.top && cells.shape(1) == window.right - window.left,
          "the cells are those of the box");
  return may_be_seen(to_known(cells).wall, presence_of(to_places(places), window, rules), rules);
}

}  // namespace

void bind_fusion(py::module& module) {
  py::class_<GhostRules>(module, "GhostRules")
      .def(py::init([](double resolution, double body, double touching, double near, double largest, double confirmed,
                       std::int64_t off) {
             require(resolution > 0.0 && off >= 0 && off < 64, "a resolution is positive, a tolerance 0 to 63 cells");
             return GhostRules{resolution, body, touching, near, largest, confirmed, off};
           }),
           py::arg("resolution"), py::arg("body"), py::arg("touching"), py::arg("near"), py::arg("largest"),
           py::arg("confirmed"), py::arg("off"),
           "Lengths in metres, but `off` in cells, and `confirmed`, a share; see ghosts.py.");
  module.def("weighed", &weighed_cells, py::arg("maps"), py::arg("locked"), py::arg("same_wall"),
             py::arg("seen_through"),
             "int8 (rows, columns): the map of all maps, int8 of that shape, which count in their order. locked: what "
             "the first one knows stays as it is. Tolerances in cells; see weighing.py.");
  module.def("without_ghosts", &without_ghosts, py::arg("maps"), py::arg("tracks"), py::arg("box"), py::arg("rules"),
             "For each of the maps, int8 (rows, columns) of `box` (top, left, bottom, right), the map without robots, "
             "None if it shows none. tracks: for each robot the number of its map, -1 for none, and the cells in "
             "which it was (n, 2: row, column).");
  module.def("may_be_ghost", &may_be_ghost, py::arg("cells"), py::arg("places"), py::arg("box"), py::arg("rules"),
             "False if a robot that was at the places (n, 2: row, column) can be no obstacle of the map, int8 (rows, "
             "columns) of `box` (top, left, bottom, right).");
}

}  // namespace map_merger
