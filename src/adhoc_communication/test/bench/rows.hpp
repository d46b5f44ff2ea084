// Rows of a benchmark: what was measured, against which bar.
#pragma once

#include <string>
#include <vector>

#include "team.hpp"

namespace adhoc_communication::bench {

struct Row {
  std::string what;
  std::string bar;
  double value;
  std::string unit;
  bool holds;
  std::string detail;
};

double seconds(Time time);
/// Of no values: -1.
double quantile(std::vector<double> values, double share);
std::string format(const char* pattern, double a, double b = 0, double c = 0);

/// Share of the air that frames of full size leave to their octets, for MediumOptions as by default.
double capacity();

// One function for each group of rows. `trials` scales the number of seeds.
std::vector<Row> unicast_rows(int trials);
std::vector<Row> multicast_rows(int trials);
std::vector<Row> route_rows(int trials);
std::vector<Row> idle_rows(int trials);

}  // namespace adhoc_communication::bench
