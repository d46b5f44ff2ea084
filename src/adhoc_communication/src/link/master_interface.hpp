// Of which bridge, bond or other an interface is a port.
#pragma once

#include <string>

namespace adhoc_communication {

struct MasterInterface {
  std::string kind;  ///< bridge, bond, ...; empty if there is none
  std::string name;
};

MasterInterface master_of(const std::string& interface);

}  // namespace adhoc_communication
