// Carries the kernel's own packets over the radio, so that TCP and UDP can be measured on the same medium: each
// Ethernet frame of a TAP device travels in a frame of ours, its ethertype in front of the octets.
//
//   tap_over_link TAP INTERFACE          makes TAP, with the address of INTERFACE; its MTU has to be smaller by 2
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "link/capability.hpp"
#include "link/file_descriptor.hpp"
#include "link/link.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::bench {
namespace {

constexpr std::size_t kAddresses = 12;  ///< octets of the two addresses in front of an Ethernet frame
constexpr std::size_t kFramesPerTurn = 64;

FileDescriptor open_tap(const std::string& name, const MacAddress& address) {
  const RaisedCapabilities raised;  // the link has lowered them again
  FileDescriptor tap(open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC));
  struct ifreq request {};
  name.copy(request.ifr_name, IFNAMSIZ - 1);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  if (!tap.is_open() || ioctl(tap.get(), TUNSETIFF, &request) != 0) {
    throw std::runtime_error("cannot make " + name + ": " + std::strerror(errno));
  }
  request.ifr_hwaddr.sa_family = 1;  // Ethernet
  std::copy(address.begin(), address.end(), request.ifr_hwaddr.sa_data);
  if (ioctl(tap.get(), SIOCSIFHWADDR, &request) != 0) {
    throw std::runtime_error("cannot give " + name + " its address: " + std::strerror(errno));
  }
  return tap;
}

void to_radio(int tap, Link& link) {
  std::array<std::uint8_t, 4096> buffer;
  std::vector<Frame> frames;
  while (frames.size() < kFramesPerTurn) {
    const ssize_t size = read(tap, buffer.data(), buffer.size());
    if (size <= static_cast<ssize_t>(kAddresses)) break;
    Frame& frame = frames.emplace_back();
    std::copy_n(buffer.begin(), 6, frame.destination.begin());
    const bool for_a_group = (frame.destination[0] & 1) != 0;
    if (for_a_group) frame.destination = wire::kEverybody;  // the radio knows no groups
    std::copy_n(buffer.begin() + 6, 6, frame.source.begin());
    frame.bytes.assign(buffer.begin() + kAddresses, buffer.begin() + size);
  }
  link.send(frames.data(), frames.size());
}

void from_radio(Link& link, int tap) {
  link.receive([tap](const Frame& frame, Time) {
    Bytes octets(frame.destination.begin(), frame.destination.end());
    octets.insert(octets.end(), frame.source.begin(), frame.source.end());
    octets.insert(octets.end(), frame.bytes.begin(), frame.bytes.end());
    if (write(tap, octets.data(), octets.size()) < 0) return;  // the kernel repeats what it misses
  });
}

void carry(const std::string& name, const std::string& interface) {
  const auto link = open_link(interface, std::nullopt, name);
  const FileDescriptor tap = open_tap(name, link->address());
  std::printf("ready\n");
  std::fflush(stdout);
  for (;;) {
    struct pollfd sources[2] = {{tap.get(), POLLIN, 0}, {link->descriptor(), POLLIN, 0}};
    poll(sources, 2, -1);
    to_radio(tap.get(), *link);
    from_radio(*link, tap.get());
  }
}

}  // namespace
}  // namespace adhoc_communication::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: tap_over_link TAP INTERFACE\n");
    return 2;
  }
  try {
    adhoc_communication::bench::carry(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tap_over_link: %s\n", error.what());
    return 1;
  }
}
