// One row of a log of the contract.
#pragma once

#include <sstream>
#include <string>

namespace adhoc_communication {

/// A name may hold a comma, which would shift the columns behind it: such a field is quoted (RFC 4180).
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char character : text) quoted += character == '"' ? "\"\"" : std::string(1, character);
  return quoted + '"';
}

template <typename Number>
Number csv_field(Number number) {
  return number;
}

template <typename First, typename... Rest>
std::string csv_row(const First& first, const Rest&... rest) {
  std::ostringstream row;
  row << csv_field(first);
  ((row << ',' << csv_field(rest)), ...);
  return row.str();
}

}  // namespace adhoc_communication
