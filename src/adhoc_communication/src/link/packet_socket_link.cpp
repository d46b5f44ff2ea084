#include "link/packet_socket_link.hpp"

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "link/capability.hpp"
#include "link/ethernet.hpp"
#include "link/interface_kind.hpp"
#include "link/mac_address.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kLargestFrame = 65536 + kEthernetHeaderSize;  // lo has an MTU of 65536

std::string existing_interfaces() {
  std::string names;
  struct if_nameindex* list = if_nameindex();
  for (auto* entry = list; entry != nullptr && entry->if_index != 0; ++entry) {
    names += (names.empty() ? "" : ", ") + std::string(entry->if_name);
  }
  if (list != nullptr) if_freenameindex(list);
  return names.empty() ? "none" : names;
}

FileDescriptor open_socket(const std::string& interface) {
  const RaisedCapabilities raised;
  FileDescriptor descriptor(
      socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));  // protocol 0: nothing is heard before bind()
  if (descriptor.is_open()) return descriptor;
  if (errno == EPERM || errno == EACCES) {
    throw LinkError("raw frames on interface '" + interface +
                    "' need the capability cap_net_raw: grant it once with \"sudo setcap cap_net_raw+ep "
                    "$(readlink -f /path/to/adhoc_communication)\", start as root, or use interface:=hub:/path");
  }
  throw LinkError("cannot open a raw socket for interface '" + interface + "': " + std::strerror(errno));
}

/// Priorities of IEEE 802.1D. Of the two of video, queues of the kernel put the other one behind best effort.
constexpr int kVideo = 4;
constexpr int kVoice = 6;

/// mac80211 takes an SO_PRIORITY of 256 to 263 for the eight priorities of IEEE 802.1D, and leaves all others at best
/// effort; queues of the kernel look at the last four bits and put 6 first, too. Those up to 6 need no right.
FileDescriptor open_urgent_socket(const std::string& interface, int user_priority) {
  FileDescriptor descriptor = open_socket(interface);
  const RaisedCapabilities raised;
  for (const int priority : {256 + user_priority, user_priority}) {
    if (setsockopt(descriptor.get(), SOL_SOCKET, SO_PRIORITY, &priority, sizeof priority) == 0) break;
  }
  return descriptor;
}

struct ifreq request_for(const std::string& interface) {
  struct ifreq request {};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  return request;
}

MacAddress hardware_address(int socket, const std::string& interface) {
  struct ifreq request = request_for(interface);
  MacAddress address{};
  if (ioctl(socket, SIOCGIFHWADDR, &request) == 0) {
    std::copy_n(reinterpret_cast<const std::uint8_t*>(request.ifr_hwaddr.sa_data), address.size(), address.begin());
  }
  return address;
}

int interface_mtu(int socket, const std::string& interface) {
  struct ifreq request = request_for(interface);
  return ioctl(socket, SIOCGIFMTU, &request) == 0 ? request.ifr_mtu : 1500;
}

bool interface_is_up(int socket, const std::string& interface) {
  struct ifreq request = request_for(interface);
  return ioctl(socket, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP);
}

}  // namespace

PacketSocketLink::PacketSocketLink(std::string interface, std::optional<MacAddress> address,
                                   const std::string& robot_name)
    : interface_(std::move(interface)),
      given_address_(address),
      robot_name_(robot_name),
      arrived_(kLargestFrame, kMostAtOnce) {
  open();
}

void PacketSocketLink::open() {
  const unsigned index = interface_.size() < IFNAMSIZ ? if_nametoindex(interface_.c_str()) : 0;
  if (index == 0) {
    throw LinkError("interface '" + interface_ + "' does not exist (existing: " + existing_interfaces() + ")");
  }
  FileDescriptor descriptor = open_socket(interface_);
  if (const auto why = objection(interface_, interface_kind(descriptor.get(), interface_))) throw LinkError(*why);
  struct sockaddr_ll local {};
  local.sll_family = AF_PACKET;
  local.sll_protocol = htons(kEthertype);
  local.sll_ifindex = static_cast<int>(index);
  if (bind(descriptor.get(), reinterpret_cast<struct sockaddr*>(&local), sizeof local) != 0) {
    throw LinkError("cannot listen on interface '" + interface_ + "': " + std::strerror(errno));
  }
  const int buffer_size = 4 << 20;
  setsockopt(descriptor.get(), SOL_SOCKET, SO_RCVBUF, &buffer_size, sizeof buffer_size);
  const int with_arrival = 1;
  setsockopt(descriptor.get(), SOL_SOCKET, SO_TIMESTAMPNS, &with_arrival, sizeof with_arrival);
  FileDescriptor video = open_urgent_socket(interface_, kVideo);
  FileDescriptor voice = open_urgent_socket(interface_, kVoice);
  // All four or none: a link that knows the new interface does not look for it again.
  index_ = static_cast<int>(index);
  video_socket_ = std::move(video);
  voice_socket_ = std::move(voice);
  socket_ = std::move(descriptor);
  read_interface();
}

/// Another radio may have taken the place of the one before, or somebody has set another mode, address or size of
/// frames.
void PacketSocketLink::read_interface() {
  trouble_ = objection(interface_, interface_kind(socket_.get(), interface_)).value_or("");
  up_ = trouble_.empty() && interface_is_up(socket_.get(), interface_);
  mtu_ = interface_mtu(socket_.get(), interface_);
  address_ = given_address_ ? *given_address_ : hardware_address(socket_.get(), interface_);
  if (is_zero(address_)) address_ = address_of_robot(robot_name_);
}

/// Reading the kernel's counter sets it to zero.
void PacketSocketLink::count_missed() {
  struct tpacket_stats statistics {};
  socklen_t size = sizeof statistics;
  if (getsockopt(socket_.get(), SOL_PACKET, PACKET_STATISTICS, &statistics, &size) == 0) {
    missed_ += statistics.tp_drops;
  }
}

bool PacketSocketLink::concerns_us(const Frame& frame) const {
  if (hears_all_) return true;
  if (frame.source == address_) return false;
  return frame.destination == address_ || frame.destination == kBroadcastAddress;
}

int PacketSocketLink::receive(const FrameTaker& take) {
  if (!socket_.is_open()) return 0;
  const std::size_t count = arrived_.fill(socket_.get());
  if (count == 0 && errno != EAGAIN) up_ = false;  // ENETDOWN is reported once; tend() looks when it is back
  for (std::size_t i = 0; i < count; ++i) {
    if (from_wire(arrived_.octets(i), arrived_.size(i), frame_) && concerns_us(frame_)) {
      take(frame_, arrived_.arrived(i));
    }
  }
  return static_cast<int>(count);
}

void PacketSocketLink::send(const Frame* first, std::size_t count) {
  if (!socket_.is_open()) {
    not_sent_ += count;
    return;
  }
  for (const Frame* end = first + count; first != end;) {
    const AccessCategory category = first->category;
    const Frame* other = std::find_if(first, end, [&](const Frame& frame) { return frame.category != category; });
    send_by(socket_of(category), first, static_cast<std::size_t>(other - first));
    first = other;
  }
}

int PacketSocketLink::socket_of(AccessCategory category) const {
  if (category == AccessCategory::kVoice) return voice_socket_.get();
  return category == AccessCategory::kVideo ? video_socket_.get() : socket_.get();
}

void PacketSocketLink::send_by(int socket, const Frame* first, std::size_t count) {
  struct sockaddr_ll remote {};
  remote.sll_family = AF_PACKET;
  remote.sll_protocol = htons(kEthertype);
  remote.sll_ifindex = index_;  // the receiver stands in the Ethernet header
  const SendOutcome outcome =
      to_send_.send(socket, first, count, reinterpret_cast<struct sockaddr*>(&remote), sizeof remote);
  not_sent_ += outcome.not_sent;
  if (outcome.error == ENETDOWN || outcome.error == ENXIO || outcome.error == ENODEV) up_ = false;
}

/// The kernel counts frames to the socket until the driver is done with them. Those of voice are left out: single
/// frames, which wait for nobody.
bool PacketSocketLink::keeps_frames() const {
  const auto keeps = [](const FileDescriptor& socket) {
    int octets = 0;
    return ioctl(socket.get(), SIOCOUTQ, &octets) == 0 && octets > 0;
  };
  return keeps(socket_) || keeps(video_socket_);
}

void PacketSocketLink::tend() {
  const unsigned index = if_nametoindex(interface_.c_str());
  if (index == 0) {
    up_ = false;
    trouble_.clear();
    return;
  }
  if (static_cast<int>(index) != index_) {  // the interface was removed and made anew
    try {
      open();
    } catch (const LinkError& error) {
      up_ = false;
      trouble_ = error.what();
    }
    return;
  }
  read_interface();
  count_missed();
}

}  // namespace adhoc_communication
