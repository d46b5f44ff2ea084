// Who this robot is on the air.
#pragma once

#include <string>

#include "wire/octets.hpp"

namespace adhoc_communication {

struct Identity {
  std::string name;
  MacAddress address{};
  BootId boot_id{};
  wire::BootTag boot = 0;
};

}  // namespace adhoc_communication
