// Records of the engine as rows of the logs.
#pragma once

#include <string>

#include "adhoc_communication/records.hpp"

namespace adhoc_communication {

/// `epoch`: Unix time at which the engine's time was 0, in milliseconds. Without the end of the line.
std::string row_of(const Record& record, long long epoch);

}  // namespace adhoc_communication
