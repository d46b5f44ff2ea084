// Measures the engine on the simulated radio in virtual time: 50 Mbit/s, 50 us per frame, own channel for each sender
// unless stated. Prints a row for each bar; ends with 1 when one is missed.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

const std::vector<std::pair<std::string, std::function<void(const Effort&, Rows&)>>> kParts = {
    {"intact", measure_intact},
    {"base", measure_base},
    {"goodput", measure_goodput},
    {"multicast", measure_multicast},
    {"mixed_rates", measure_mixed_rates},
    {"routes", measure_routes},
    {"wifi", measure_wifi},
    {"idle", measure_idle},
    {"priority", measure_priority},
    {"mobile", measure_mobile},
    {"channels", measure_channels}};

int run(const std::string& part, const Effort& effort, const std::string& file) {
  Rows rows(file);
  for (const auto& [name, measure] : kParts) {
    if (part.empty() || name == part) measure(effort, rows);
  }
  return rows.status();
}

int usage() {
  std::string parts;
  for (const auto& [name, measure] : kParts) parts += (parts.empty() ? "" : "|") + name;
  std::fprintf(stderr,
               "usage: bench_engine [--part %s] [--trials N] [--minutes M] [--patience S] [--seed N] [--json FILE]\n",
               parts.c_str());
  return 2;
}

}  // namespace
}  // namespace adhoc_communication::bench

int main(int argc, char** argv) {
  using adhoc_communication::bench::kParts;
  adhoc_communication::bench::Effort effort;
  std::string part;
  std::string file;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 == argc) return adhoc_communication::bench::usage();
    const std::string value = argv[i + 1];
    if (std::strcmp(argv[i], "--trials") == 0 && std::atoi(value.c_str()) > 0) {
      effort.trials = std::atoi(value.c_str());
    } else if (std::strcmp(argv[i], "--minutes") == 0 && std::atof(value.c_str()) > 0) {
      effort.minutes = std::atof(value.c_str());
    } else if (std::strcmp(argv[i], "--patience") == 0 && std::atof(value.c_str()) > 0) {
      effort.patience = std::atof(value.c_str());
    } else if (std::strcmp(argv[i], "--seed") == 0 && std::atoll(value.c_str()) > 0) {
      effort.seed = std::strtoull(value.c_str(), nullptr, 10);
    } else if (std::strcmp(argv[i], "--json") == 0) {
      file = value;
    } else if (std::strcmp(argv[i], "--part") == 0 &&
               std::any_of(kParts.begin(), kParts.end(), [&](const auto& known) { return known.first == value; })) {
      part = value;
    } else {
      return adhoc_communication::bench::usage();
    }
  }
  return adhoc_communication::bench::run(part, effort, file);
}
