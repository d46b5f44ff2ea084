#include "rows.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace adhoc_communication::bench {

double seconds(Time time) { return static_cast<double>(time.count()) * 1e-9; }

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return -1;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

std::string format(const char* pattern, double a, double b, double c) {
  char text[128];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

double capacity() {
  const MediumOptions medium;
  return 1500.0 * 8 / (1500.0 * 8 / medium.bit_rate + static_cast<double>(medium.frame_overhead.count()) * 1e-9);
}

}  // namespace adhoc_communication::bench
