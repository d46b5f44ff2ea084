#include "link/interface_kind.hpp"

#include <linux/wireless.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>

#include "link/master_interface.hpp"

namespace adhoc_communication {
namespace {

std::string in_words(unsigned mode) {
  if (mode == IW_MODE_INFRA) return "is a station of an access point (mode managed)";
  if (mode == IW_MODE_MASTER) return "is an access point (mode AP)";
  return "is in monitor mode";
}

/// The others, as batman-adv and VRFs, leave frames to those who listen at their ports.
bool takes_all_frames(const std::string& master_kind) {
  return master_kind == "bridge" || master_kind == "bond" || master_kind == "team";
}

}  // namespace

InterfaceKind interface_kind(int socket, const std::string& interface) {
  InterfaceKind kind;
  struct ifreq request {};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  if (ioctl(socket, SIOCGIFHWADDR, &request) == 0) kind.hardware = request.ifr_hwaddr.sa_family;
  struct iwreq wireless {};
  interface.copy(wireless.ifr_name, IFNAMSIZ - 1);
  if (ioctl(socket, SIOCGIWMODE, &wireless) == 0) kind.wireless_mode = wireless.u.mode;
  kind.master = master_of(interface);
  return kind;
}

std::optional<std::string> objection(const std::string& interface, const InterfaceKind& kind) {
  const std::string name = "interface '" + interface + "'";
  if (kind.hardware != ARPHRD_ETHER && kind.hardware != ARPHRD_LOOPBACK) {
    return name + " carries no Ethernet frames (hardware type " + std::to_string(kind.hardware) +
           "): a tunnel or modem will not do, give a wireless interface in ad hoc or mesh mode, or an Ethernet";
  }
  if (takes_all_frames(kind.master.kind)) {
    return name + " is a port of " + kind.master.kind + " " + kind.master.name +
           ", which takes all that it hears: use " + kind.master.name;
  }
  const bool is_wrong =
      kind.wireless_mode && (*kind.wireless_mode == IW_MODE_INFRA || *kind.wireless_mode == IW_MODE_MASTER ||
                             *kind.wireless_mode == IW_MODE_MONITOR);
  if (!is_wrong) return std::nullopt;
  return name + " " + in_words(*kind.wireless_mode) + ", where robots do not hear each other directly: set it to " +
         "ad hoc (\"sudo iw dev " + interface + " set type ibss\") or mesh mode, see docs/tutorials/radio.md";
}

}  // namespace adhoc_communication
