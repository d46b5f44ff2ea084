// Measures the memory of an engine with a hundred neighbours: over an hour of traffic, and under a million hostile
// frames. The engine has a process of its own; time is virtual.
//
//   bench_memory [--minutes M] [--frames N] [--json FILE]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "crowd.hpp"
#include "hostile_frames.hpp"
#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

constexpr double kMost = 64;           // MB
constexpr double kGrowth = 0.5;        // MB, what still counts as flat
constexpr std::size_t kBurst = 10;     // hostile frames each millisecond
constexpr Time kListening = 10s;       // between two looks at what neighbours say
constexpr std::size_t kRestarts = 20;  // neighbours whose former run is sent again

double megabytes(std::size_t kilobytes) { return static_cast<double>(kilobytes) * 1024e-6; }

std::vector<TeamKey> key() { return {TeamKey{7}}; }

/// Looks six times; the first look is the one that the last is measured against.
Row traffic(Crowd& crowd, double minutes) {
  const Time sixth(static_cast<Time::rep>(minutes * 10e9));
  std::vector<double> resident;
  std::string looks;
  for (int i = 0; i < 6; ++i) {
    crowd.run_for(sixth);
    resident.push_back(megabytes(crowd.resident()));
    looks += format(i == 0 ? "%.2f" : ", %.2f", resident.back());
  }
  const double growth = resident.back() - resident.front();
  return {format("memory with 100 neighbours: growth from %.3g to %.3g min of traffic", minutes / 6, minutes),
          format("<= %.2f", kGrowth),
          growth,
          "MB",
          growth <= kGrowth,
          looks + format(" MB; %.0f packets delivered", static_cast<double>(crowd.delivered()))};
}

Row attack(Crowd& crowd, bool sealed, std::size_t frames) {
  HostileFrames hostile(sealed, 1);
  hostile.listen(crowd.recorded());
  for (std::size_t neighbor = 0; neighbor < kRestarts; ++neighbor) crowd.restart(neighbor);
  Time listens = crowd.now() + kListening;
  for (std::size_t sent = 0; sent < frames; sent += kBurst) {
    std::vector<Frame> burst;
    for (std::size_t i = 0; i < kBurst; ++i) burst.push_back(hostile.next());
    crowd.inject(burst);
    crowd.run_for(1ms);
    if (crowd.now() < listens) continue;
    listens = crowd.now() + kListening;
    hostile.listen(crowd.recorded());
  }
  const std::uint64_t before = crowd.delivered();
  crowd.run_for(30s);
  const double peak = megabytes(crowd.peak());
  return {format("memory with 100 neighbours and %.0f hostile frames, peak, ", static_cast<double>(frames)) +
              (sealed ? "with a key" : "without a key"),
          format("<= %.0f", kMost),
          peak,
          "MB",
          peak <= kMost,
          format("%.0f packets between neighbours in the 30 s after", static_cast<double>(crowd.delivered() - before))};
}

void measure(double minutes, std::size_t frames, Rows& rows) {
  {
    Crowd sealed(key());
    rows.add(traffic(sealed, minutes));
    rows.add(attack(sealed, true, frames));
  }
  Crowd open({});
  open.run_for(60s);
  rows.add(attack(open, false, frames));
}

}  // namespace
}  // namespace adhoc_communication::bench

int main(int argc, char** argv) {
  double minutes = 60;
  std::size_t frames = 1'000'000;
  std::string file;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 < argc && std::strcmp(argv[i], "--minutes") == 0 && std::atof(argv[i + 1]) > 0) {
      minutes = std::atof(argv[i + 1]);
    } else if (i + 1 < argc && std::strcmp(argv[i], "--frames") == 0 && std::atol(argv[i + 1]) > 0) {
      frames = static_cast<std::size_t>(std::atol(argv[i + 1]));
    } else if (i + 1 < argc && std::strcmp(argv[i], "--json") == 0) {
      file = argv[i + 1];
    } else {
      std::fprintf(stderr, "usage: bench_memory [--minutes M] [--frames N] [--json FILE]\n");
      return 2;
    }
  }
  adhoc_communication::bench::Rows rows(file);
  adhoc_communication::bench::measure(minutes, frames, rows);
  return rows.status();
}
