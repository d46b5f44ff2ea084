#include "rows.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>

namespace adhoc_communication::bench {

namespace {

std::string json(const std::vector<Row>& rows) {
  std::string out = "[\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    out += "  {\"what\": \"" + row.what + "\", \"bar\": \"" + row.bar + "\", \"value\": " + format("%.6g", row.value) +
           ", \"unit\": \"" + row.unit + "\", \"holds\": " + (row.holds ? "true" : "false") + ", \"detail\": \"" +
           row.detail + "\"}" + (i + 1 < rows.size() ? ",\n" : "\n");
  }
  return out + "]\n";
}

void print(const Row& row) {
  std::printf("%s %-62s %-10s %10.4g %-11s %s\n", row.holds ? "ok  " : "MISS", row.what.c_str(), row.bar.c_str(),
              row.value, row.unit.c_str(), row.detail.c_str());
  std::fflush(stdout);
}

}  // namespace

void Rows::add(Row row) {
  print(row);
  rows_.push_back(std::move(row));
  if (!file_.empty()) std::ofstream(file_) << json(rows_);
}

int Rows::status() const {
  return std::all_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.holds; }) ? 0 : 1;
}

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
