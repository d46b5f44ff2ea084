// Random scenarios from consecutive seeds. A broken promise ends the program with the seed, the way to see it again,
// and the events before it.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "scenario_run.hpp"

namespace {

using adhoc_communication::Outcome;
using adhoc_communication::RunOptions;
using adhoc_communication::Scenario;

constexpr char kUsage[] =
    "engine_scenarios [--seed N] [--count N] [--events N] [--trace] [--hashes] [--keep-going]\n"
    "                 [--contention] [--json FILE]\n"
    "  --seed N      first seed (1)\n"
    "  --count N     scenarios to play, one per seed (1)\n"
    "  --events N    end each scenario after so many events\n"
    "  --trace       print every event\n"
    "  --hashes      print a hash of the events of each seed, to compare two versions of the engine\n"
    "  --keep-going  play the other seeds, too, after a broken promise\n"
    "  --contention  robots contend for one channel in each scenario; otherwise in a sixth of them\n"
    "  --json FILE   write what was found as the row of a benchmark\n";

struct Arguments {
  std::uint64_t seed = 1;
  std::uint64_t count = 1;
  bool keep_going = false;
  bool contention = false;
  std::string json;
  bool hashes = false;
  RunOptions run;
};

[[noreturn]] void refuse(const std::string& why) {
  std::fprintf(stderr, "engine_scenarios: %s\n%s", why.c_str(), kUsage);
  std::exit(2);
}

std::uint64_t number(const std::string& option, const char* text) {
  char* end = nullptr;
  const std::uint64_t value = text == nullptr ? 0 : std::strtoull(text, &end, 10);
  if (text == nullptr || *text == '\0' || *end != '\0') refuse(option + " needs a number");
  return value;
}

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--seed") {
      arguments.seed = number(option, argv[++i]);
    } else if (option == "--count") {
      arguments.count = number(option, argv[++i]);
    } else if (option == "--events") {
      arguments.run.most_events = number(option, argv[++i]);
    } else if (option == "--trace") {
      arguments.run.trace = true;
    } else if (option == "--hashes") {
      arguments.hashes = true;
    } else if (option == "--json" && i + 1 < argc) {
      arguments.json = argv[++i];
    } else if (option == "--contention") {
      arguments.contention = true;
    } else if (option == "--keep-going") {
      arguments.keep_going = true;
    } else if (option == "--help") {
      std::printf("%s", kUsage);
      std::exit(0);
    } else {
      refuse("unknown option '" + option + "'");
    }
  }
  return arguments;
}

void write_row(const std::string& file, std::uint64_t seeds, std::uint64_t events, std::uint64_t violations,
               bool contention) {
  std::ofstream(file) << "[\n  {\"what\": \"broken promises in random scenarios\", \"bar\": \"0\", \"value\": "
                      << violations << ", \"unit\": \"\", \"holds\": " << (violations == 0 ? "true" : "false")
                      << ", \"detail\": \"" << events << " events, " << seeds
                      << (contention ? " seeds, robots contend for one channel in each"
                                     : " seeds, a third of them on one channel, half of these contended")
                      << "\"}\n]\n";
}

void report(const Scenario& scenario, const Outcome& outcome, bool contention) {
  std::printf("%sseed %llu (%s), event %llu: %s\nsee it again: engine_scenarios --seed %llu%s --trace\n",
              outcome.tail.c_str(), static_cast<unsigned long long>(scenario.seed), describe(scenario).c_str(),
              static_cast<unsigned long long>(outcome.events), outcome.violation.c_str(),
              static_cast<unsigned long long>(scenario.seed), contention ? " --contention" : "");
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t events = 0, sends = 0, deliveries = 0, played = 0, violations = 0, full = 0;
  for (; played < arguments.count && (violations == 0 || arguments.keep_going); ++played) {
    const Scenario scenario = adhoc_communication::make_scenario(arguments.seed + played, arguments.contention);
    const Outcome outcome = adhoc_communication::run(scenario, arguments.run);
    events += outcome.events;
    sends += outcome.sends;
    deliveries += outcome.deliveries;
    full += outcome.room_taken > 0.9 ? 1 : 0;
    if (arguments.hashes) {
      std::printf("seed %llu: %016llx\n", static_cast<unsigned long long>(scenario.seed),
                  static_cast<unsigned long long>(outcome.trace_hash));
    }
    if (outcome.violation.empty()) continue;
    ++violations;
    report(scenario, outcome, arguments.contention);
    std::fflush(stdout);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf(
      "%llu seeds, %llu events (%.0f /s), %llu sends, %llu deliveries, in %llu seeds a robot had no room for packets, "
      "%llu violations\n",
      static_cast<unsigned long long>(played), static_cast<unsigned long long>(events),
      static_cast<double>(events) / seconds, static_cast<unsigned long long>(sends),
      static_cast<unsigned long long>(deliveries), static_cast<unsigned long long>(full),
      static_cast<unsigned long long>(violations));
  if (!arguments.json.empty()) write_row(arguments.json, played, events, violations, arguments.contention);
  return violations == 0 ? 0 : 1;
}
