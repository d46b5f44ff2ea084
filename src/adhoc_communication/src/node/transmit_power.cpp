#include <linux/wireless.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "link/capability.hpp"
#include "link/file_descriptor.hpp"
#include "node/node.hpp"

namespace adhoc_communication {

std::string set_transmit_power(const std::string& interface, int dbm) {
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  struct iwreq request {};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  if (ioctl(socket.get(), SIOCGIWNAME, &request) != 0) return "";  // not a wireless interface
  request.u = {};
  request.u.txpower.value = dbm;
  request.u.txpower.fixed = 1;
  request.u.txpower.flags = IW_TXPOW_DBM;
  const RaisedCapabilities raised;
  if (ioctl(socket.get(), SIOCSIWTXPOW, &request) == 0) return "";
  return "the transmit power of interface " + interface + " cannot be set to " + std::to_string(dbm) + " dBm (" +
         std::strerror(errno) + "); set it with \"sudo iw dev " + interface + " set txpower fixed " +
         std::to_string(100 * dbm) + "\"";
}

}  // namespace adhoc_communication
