// Rows of a benchmark: what was measured, against which bar.
#pragma once

#include <string>
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

void print(const Row& row);
/// Writes the rows to `file` unless that is empty; returns what the program ends with: 1 when a bar was missed.
int conclude(const std::vector<Row>& rows, const std::string& file);

/// How much is measured.
struct Effort {
  int trials = 20;      ///< scales the number of seeds
  double minutes = 10;  ///< of virtual time, where a mission is driven
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

// One function for each group of rows.
std::vector<Row> intact_rows(const Effort& effort);
std::vector<Row> goodput_rows(const Effort& effort);
std::vector<Row> multicast_rows(const Effort& effort);
std::vector<Row> mixed_rates_rows(const Effort& effort);
std::vector<Row> route_rows(const Effort& effort);
std::vector<Row> idle_rows(const Effort& effort);
std::vector<Row> priority_rows(const Effort& effort);
std::vector<Row> mobile_rows(const Effort& effort);

}  // namespace adhoc_communication::bench
