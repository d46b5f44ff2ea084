#include "link/hub_link.hpp"
#include "link/link.hpp"
#include "link/packet_socket_link.hpp"

namespace adhoc_communication {

std::unique_ptr<Link> open_link(const std::string& interface, std::optional<MacAddress> address,
                                const std::string& robot_name) {
  const std::string hub_prefix = "hub:";
  if (interface.compare(0, hub_prefix.size(), hub_prefix) == 0) {
    return std::make_unique<HubLink>(interface.substr(hub_prefix.size()), address, robot_name);
  }
  return std::make_unique<PacketSocketLink>(interface, address, robot_name);
}

}  // namespace adhoc_communication
