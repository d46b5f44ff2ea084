// Whether a network interface can carry frames between robots.
#pragma once

#include <optional>
#include <string>

#include "link/master_interface.hpp"

namespace adhoc_communication {

struct InterfaceKind {
  int hardware = 0;                       ///< ARPHRD_*
  std::optional<unsigned> wireless_mode;  ///< IW_MODE_*; nothing if it is not wireless, or does not tell
  MasterInterface master{};               ///< of which it is a port
};

/// `socket`: any.
InterfaceKind interface_kind(int socket, const std::string& interface);

/// One sentence that names the remedy, or nothing if robots can hear each other over such an interface.
std::optional<std::string> objection(const std::string& interface, const InterfaceKind& kind);

}  // namespace adhoc_communication
