// Rows of a benchmark: what was measured, against which bar.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "payloads.hpp"
#include "simulation/team.hpp"

namespace adhoc_communication::bench {

struct Row {
  std::string what;
  std::string bar;
  double value;
  std::string unit;
  bool holds;
  std::string detail;
};

/// The rows of one run. Each is printed and written as it comes, so that a run which is interrupted keeps what it has.
class Rows {
 public:
  /// `file`: for the rows as JSON; empty for none.
  explicit Rows(std::string file) : file_(std::move(file)) {}

  void add(Row row);
  /// What the program ends with: 1 when a bar was missed.
  int status() const;

 private:
  std::string file_;
  std::vector<Row> rows_;
};

/// How much is measured.
struct Effort {
  int trials = 20;         ///< scales the number of seeds
  double minutes = 10;     ///< of virtual time, where a mission is driven
  double patience = 600;   ///< seconds of processor time after which a mission is stopped where it is
  std::uint64_t seed = 1;  ///< of a mission, or the first of several
};

double seconds(Time time);
double wall_seconds();
/// Of no values: -1.
double quantile(std::vector<double> values, double share);
std::string format(const char* pattern, double a, double b = 0, double c = 0);

/// Share of the air that frames of full size leave to their octets, for MediumOptions as by default.
double capacity();

/// Sends per frame that the best code needs on average: until the worst of `children` has any `frames` of them.
double ideal_sends(int frames, int children, double loss);

// Each measures one group of rows.
void measure_intact(const Effort& effort, Rows& rows);
void measure_base(const Effort& effort, Rows& rows);
void measure_goodput(const Effort& effort, Rows& rows);
void measure_multicast(const Effort& effort, Rows& rows);
void measure_mixed_rates(const Effort& effort, Rows& rows);
void measure_routes(const Effort& effort, Rows& rows);
void measure_wifi(const Effort& effort, Rows& rows);
void measure_idle(const Effort& effort, Rows& rows);
void measure_priority(const Effort& effort, Rows& rows);
void measure_mobile(const Effort& effort, Rows& rows);
void measure_channels(const Effort& effort, Rows& rows);

}  // namespace adhoc_communication::bench
