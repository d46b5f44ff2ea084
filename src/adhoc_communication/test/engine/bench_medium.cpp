// Measures the simulated radio alone, without robots: wandering nodes that send broadcasts one after another.
//
//   bench_medium [--nodes N] [--seconds S] [--json FILE]      (S: virtual; rates are per second of CPU time)
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "medium/medium.hpp"
#include "random_waypoint.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

constexpr double kBar = 1e6;       // pairs of frame and receiver per second
constexpr double kNeighbors = 20;  // of a node, on the average
constexpr Time kMovement = 100ms;  // between positions
constexpr Time kSpacing = 10ms;    // between frames of a node
constexpr std::size_t kOctets = 1400;

struct Result {
  std::string what;
  double frames = 0;
  double pairs = 0;
  double cpu_time = 0;
};

Frame broadcast_from(std::size_t node) {
  Frame frame;
  frame.destination.fill(0xff);
  frame.source = {2, 0, 0, 0, static_cast<std::uint8_t>(node >> 8), static_cast<std::uint8_t>(node)};
  frame.bytes.resize(kOctets);
  return frame;
}

/// The area grows with the number of nodes, so that each keeps about as many neighbours.
std::vector<RandomWaypoint> wanderers(std::size_t nodes, double range) {
  WaypointOptions options;
  options.width = options.height = range * std::sqrt(static_cast<double>(nodes) * std::acos(-1.0) / kNeighbors);
  std::vector<RandomWaypoint> robots;
  for (std::size_t node = 0; node < nodes; ++node) robots.emplace_back(options, node + 1);
  return robots;
}

Result measure(const std::string& what, const MediumOptions& options, double range, std::size_t nodes, double seconds) {
  Medium medium(options, 1);
  std::vector<RandomWaypoint> robots = wanderers(nodes, range);
  std::vector<Frame> frames;
  for (std::size_t node = 0; node < nodes; ++node) {
    medium.add_node("robot_" + std::to_string(node));
    frames.push_back(broadcast_from(node));
  }
  const std::clock_t start = std::clock();
  const Time end(static_cast<Time::rep>(seconds * 1e9));
  const Time spacing = kSpacing / static_cast<Time::rep>(nodes);
  std::size_t node = 0;
  for (Time now{0}; now < end; now += spacing, node = (node + 1) % nodes) {
    if (now % kMovement < kSpacing) {
      const Position position = robots[node].at(now);
      medium.set_position(node, position.x, position.y);
    }
    medium.transmit(node, frames[node], now);
    while (medium.next_delivery() && *medium.next_delivery() <= now) medium.deliveries(*medium.next_delivery());
  }
  const Medium::Counters& counters = medium.counters();
  const double pairs = static_cast<double>(counters.delivered + counters.lost + counters.collided + counters.unheard);
  const double cpu_time = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return {what, static_cast<double>(counters.frames), pairs, cpu_time};
}

/// Squares of 20 m, with walls of 0.2 m.
Walls rooms(double width) {
  Walls walls;
  walls.resolution = 0.2;
  walls.width = static_cast<std::size_t>(width / walls.resolution) + 1;
  walls.cells.resize(walls.width * walls.width);
  for (std::size_t i = 0; i < walls.cells.size(); ++i) {
    walls.cells[i] = i % walls.width % 100 == 0 || i / walls.width % 100 == 0;
  }
  return walls;
}

std::vector<Result> measure_all(std::size_t nodes, double seconds) {
  const double range = 26.6;  // of the default path loss
  MediumOptions plain;
  plain.range = range;
  plain.loss = 0.1;
  MediumOptions path_loss = plain;
  path_loss.path_loss = PathLoss();
  MediumOptions full = path_loss;
  full.shadowing.deviation = 4.0;
  full.walls = rooms(range * std::sqrt(static_cast<double>(nodes) * std::acos(-1.0) / kNeighbors));
  MediumOptions contention = path_loss;
  contention.contention = true;
  return {measure("range", plain, range, nodes, seconds), measure("path loss", path_loss, range, nodes, seconds),
          measure("path loss, walls, shadowing", full, range, nodes, seconds),
          measure("path loss, contention", contention, range, nodes, seconds)};
}

std::string as_row(const Result& result, std::size_t nodes) {
  const double rate = result.pairs / result.cpu_time;
  char row[400];
  std::snprintf(row, sizeof row,
                "  {\"what\": \"medium, %zu wandering nodes, %s\", \"bar\": \">= %.0e\", \"value\": %.4g, \"unit\": "
                "\"frame-receiver pairs/s\", \"holds\": %s, \"detail\": \"%.0f frames/s\"}",
                nodes, result.what.c_str(), kBar, rate, rate >= kBar ? "true" : "false",
                result.frames / result.cpu_time);
  return row;
}

int run(std::size_t nodes, double seconds, const std::string& file) {
  std::string rows;
  bool holds = true;
  for (const Result& result : measure_all(nodes, seconds)) {
    const double rate = result.pairs / result.cpu_time;
    holds = holds && rate >= kBar;
    std::printf("%4zu nodes, %-28s %9.0f frames/s  %10.0f pairs/s  %s\n", nodes, result.what.c_str(),
                result.frames / result.cpu_time, rate, rate >= kBar ? "holds" : "MISSED");
    rows += (rows.empty() ? "" : ",\n") + as_row(result, nodes);
  }
  if (!file.empty()) std::ofstream(file) << "[\n" << rows << "\n]\n";
  return holds ? 0 : 1;
}

}  // namespace
}  // namespace adhoc_communication

int main(int argc, char** argv) {
  std::size_t nodes = 100;
  double seconds = 20.0;
  std::string file;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 < argc && std::strcmp(argv[i], "--nodes") == 0 && std::atoi(argv[i + 1]) > 0) {
      nodes = static_cast<std::size_t>(std::atoi(argv[i + 1]));
    } else if (i + 1 < argc && std::strcmp(argv[i], "--seconds") == 0 && std::atof(argv[i + 1]) > 0) {
      seconds = std::atof(argv[i + 1]);
    } else if (i + 1 < argc && std::strcmp(argv[i], "--json") == 0) {
      file = argv[i + 1];
    } else {
      std::fprintf(stderr, "usage: bench_medium [--nodes N] [--seconds S] [--json FILE]\n");
      return 2;
    }
  }
  return adhoc_communication::run(nodes, seconds, file);
}
