// Commands of the radio's control socket.
#pragma once

#include <string>

#include "medium/medium.hpp"

namespace adhoc_communication {

/// Carries out one line. Returns one sentence when it is refused, else nothing.
/// A robot is named before its interface or hub client appears, too: its position is kept for it.
std::string carry_out(const std::string& line, Medium& medium, Time now);

/// The node of that name, made if need be. Throws std::invalid_argument where there can be none.
Medium::Node node_named(Medium& medium, const std::string& name);

/// Counters of the whole and of each robot as JSON.
std::string statistics_json(const Medium& medium);

}  // namespace adhoc_communication
