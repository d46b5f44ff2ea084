#include "link/capability.hpp"

#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

namespace adhoc_communication {
namespace {

constexpr std::uint32_t kOurs = 1u << CAP_NET_RAW | 1u << CAP_NET_ADMIN;

/// Makes those of our capabilities effective that are permitted, or none. Without permission nothing changes: root
/// stays root, and opening a socket says what is missing.
void set_effective(bool on) {
  struct __user_cap_header_struct header {
    _LINUX_CAPABILITY_VERSION_3, 0
  };
  struct __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3] = {};
  if (syscall(SYS_capget, &header, data) != 0) return;
  data[0].effective = on ? data[0].effective | (data[0].permitted & kOurs) : data[0].effective & ~kOurs;
  syscall(SYS_capset, &header, data);
}

}  // namespace

void lower_capabilities() { set_effective(false); }

RaisedCapabilities::RaisedCapabilities() { set_effective(true); }

RaisedCapabilities::~RaisedCapabilities() { set_effective(false); }

}  // namespace adhoc_communication
