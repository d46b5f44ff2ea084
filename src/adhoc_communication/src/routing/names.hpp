// What robots are called in events, states and records.
#pragma once

#include <optional>
#include <string>

#include "identity.hpp"
#include "routing/robot_directory.hpp"
#include "texts.hpp"

namespace adhoc_communication::routing {

/// Nothing for a robot that is not known.
inline std::optional<std::string> name_of(const Identity& self, const RobotDirectory& directory,
                                          const MacAddress& robot) {
  if (robot == self.address) return self.name;
  const Robot* known = directory.find(robot);
  return known == nullptr ? std::nullopt : std::optional(known->name);
}

inline std::string name_or_address(const Identity& self, const RobotDirectory& directory, const MacAddress& robot) {
  return name_of(self, directory, robot).value_or(address_text(robot));
}

}  // namespace adhoc_communication::routing
