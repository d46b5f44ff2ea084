#include "weighing.hpp"

#include <algorithm>
#include <utility>

#include "cell_values.hpp"

namespace map_merger {
namespace {

Mask unknown_of(const Known& map) { return ~(map.wall | map.floor); }

// The maps without the walls where another one saw nothing but floor around.
std::vector<Known> without_refuted_walls(const std::vector<Known>& maps, std::int64_t seen_through) {
  Mask open(maps.front().wall.rows(), maps.front().wall.columns());
  for (const Known& map : maps) open |= shrunk(map.floor, seen_through);
  std::vector<Known> layers;
  for (const Known& map : maps) layers.push_back({without(map.wall, open), map.floor | (map.wall & open)});
  return layers;
}

// Those of the cells that as many maps hold for wall as for floor, or more.
Mask not_outvoted(const Mask& cells, const std::vector<Known>& layers) {
  Mask result(cells.rows(), cells.columns());
  for_each(cells, [&](std::int64_t row, std::int64_t column) {
    int votes = 0;
    for (const Known& layer : layers) votes += layer.wall.at(row, column) - layer.floor.at(row, column);
    if (votes >= 0) result.set(row, column, column + 1);
  });
  return result;
}

Mask disputed_of(const std::vector<Known>& layers, const Mask& none) {
  Mask wall = none, floor = none;
  for (const Known& layer : layers) wall |= layer.wall, floor |= layer.floor;
  return wall & floor;
}

// Between a wall that is there and one of the layer, each within same_wall cells, on opposite sides.
Mask pinched(const Mask& present, const Mask& wall, std::int64_t same_wall) {
  Mask result(wall.rows(), wall.columns());
  const auto beside = [&](const Mask& mask, std::int64_t row_step, std::int64_t column_step) {
    Mask side = moved(mask, row_step, column_step);
    for (std::int64_t step = 2; step <= same_wall; ++step) side |= moved(mask, step * row_step, step * column_step);
    return side;
  };
  for (const auto& [row_step, column_step] : {std::pair{1, 0}, std::pair{0, 1}}) {
    result |= beside(present, row_step, column_step) & beside(wall, -row_step, -column_step);
    result |= beside(present, -row_step, -column_step) & beside(wall, row_step, column_step);
  }
  return result;
}

void set_wall(Known& map, const Mask& cells) {
  map.wall |= cells;
  map.floor.remove(cells);
}

// Draws the layer into the map; returns its walls that may not be drawn.
Mask add(Known& map, const Known& layer, const Mask& kept_floor, std::int64_t same_wall) {
  const Mask unknown = unknown_of(map);
  const Mask floor = without(layer.floor & unknown, pinched(map.wall, layer.wall, same_wall));
  const Mask alone = without(layer.wall, spread(map.wall, same_wall));
  // Reaches over the other wall's tolerance, so that the two hang together.
  const Mask joint = layer.wall & spread(alone, same_wall);
  map.floor |= floor;
  const Mask closing = layer.wall & crossed(map.floor) & unknown;
  const Mask drawn = without(joint | closing, map.wall);
  set_wall(map, without(drawn, kept_floor));
  return drawn & kept_floor;
}

// Unknown gaps up to two cells wide.
Mask gaps_of(const Known& map) {
  const Mask seen = map.wall | map.floor;
  return without(shrunk(spread(seen, 1), 1), seen);
}

void close_gaps(Known& map, const std::vector<Known>& maps) {
  Mask gaps = gaps_of(map);
  if (!gaps.any()) return;
  // What one robot by itself did not see between what it saw is no seam.
  for (const Known& each : maps) gaps.remove(gaps_of(each));
  gaps &= spread(map.floor, 1);
  const Mask solid = gaps & spread(map.wall, 1);
  map.floor |= gaps;
  set_wall(map, solid);
}

// One bit for each of 64 bytes, which are 0 or 1.
std::uint64_t packed(const std::uint8_t* bytes) {
  std::uint64_t bits = 0;
  for (int i = 0; i < 64; i += 8) {
    std::uint64_t eight = 0;
    for (int byte = 0; byte < 8; ++byte) eight |= static_cast<std::uint64_t>(bytes[i + byte]) << (8 * byte);
    // The product moves the lowest bit of each byte into the highest byte.
    bits |= (eight * 0x0102040810204080U >> 56) << i;
  }
  return bits;
}

}  // namespace

Known known_of(const std::int8_t* cells, std::int64_t rows, std::int64_t columns) {
  Known map{Mask(rows, columns), Mask(rows, columns)};
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t word = 0; word < map.wall.words(); ++word) {
      const std::int8_t* first = cells + row * columns + word * 64;
      const std::int64_t count = std::min<std::int64_t>(64, columns - word * 64);
      std::uint8_t wall[64] = {}, known[64] = {};
      for (std::int64_t i = 0; i < count; ++i) wall[i] = first[i] >= kOccupiedFrom, known[i] = first[i] >= 0;
      map.wall.row(row)[word] = packed(wall);
      map.floor.row(row)[word] = packed(known) & ~map.wall.row(row)[word];
    }
  }
  return map;
}

Known weighed(const std::vector<Known>& maps, bool locked, const Tolerance& tolerance) {
  const Known& local = maps.front();
  const Mask none(local.wall.rows(), local.wall.columns());
  std::vector<Known> layers = without_refuted_walls(maps, tolerance.seen_through);
  if (locked) layers.erase(layers.begin());
  const Mask doubtful = disputed_of(layers, none), kept_floor = locked ? local.floor : none;
  Known result = locked ? local : Known{none, none};
  set_wall(result, without(not_outvoted(locked ? doubtful : doubtful | local.wall, layers), result.floor));
  Mask refused = none;
  for (const Known& layer : layers) refused |= add(result, layer, kept_floor, tolerance.same_wall);
  if (locked) {
    set_wall(result, without(spread(refused, 1), local.wall | local.floor));
    for (const Known& layer : layers) set_wall(result, spread(layer.wall & kept_floor, 1) & unknown_of(result));
  }
  close_gaps(result, maps);
  return result;
}

}  // namespace map_merger
