#include "link/hub_link.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "link/ethernet.hpp"
#include "link/mac_address.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kLargestFrame = 4096;
/// A launch file may start the radio and the robots at once.
constexpr int kAttemptsAtStart = 60;
constexpr auto kPauseBetweenAttempts = std::chrono::milliseconds(50);

FileDescriptor connect_to(const std::string& path) {
  struct sockaddr_un remote {};
  remote.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof remote.sun_path) {
    throw LinkError("hub socket '" + path + "': a path of 1 to " + std::to_string(sizeof remote.sun_path - 1) +
                    " characters is needed behind hub:");
  }
  path.copy(remote.sun_path, path.size());
  FileDescriptor descriptor(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (connect(descriptor.get(), reinterpret_cast<struct sockaddr*>(&remote), sizeof remote) != 0) {
    throw LinkError("no radio answers at hub socket '" + path + "' (" + std::strerror(errno) +
                    "): start \"rosrun adhoc_communication radio --hub " + path + "\" first");
  }
  return descriptor;
}

}  // namespace

HubLink::HubLink(std::string path, std::optional<MacAddress> address, std::string robot_name)
    : path_(std::move(path)),
      robot_name_(std::move(robot_name)),
      address_(address ? *address : address_of_robot(robot_name_)),
      arrived_(kLargestFrame, kMostAtOnce) {
  for (int attempt = 1; !socket_.is_open(); ++attempt) {
    try {
      connect();
    } catch (const LinkError&) {
      if (attempt == kAttemptsAtStart) throw;
      std::this_thread::sleep_for(kPauseBetweenAttempts);
    }
  }
}

void HubLink::connect() {
  FileDescriptor descriptor = connect_to(path_);
  if (::send(descriptor.get(), robot_name_.data(), robot_name_.size(), MSG_NOSIGNAL) < 0) {
    throw LinkError("hub socket '" + path_ + "' refuses this robot: " + std::strerror(errno));
  }
  socket_ = std::move(descriptor);
}

int HubLink::receive(const FrameTaker& take) {
  if (!socket_.is_open()) return 0;
  const std::size_t count = arrived_.fill(socket_.get());
  bool ended = count == 0 && errno != EAGAIN;
  std::size_t frames = 0;
  for (; frames < count && !ended; ++frames) {
    ended = arrived_.size(frames) == 0;
    if (!from_wire(arrived_.octets(frames), arrived_.size(frames), frame_) || frame_.source == address_) continue;
    if (frame_.destination == address_ || frame_.destination == kBroadcastAddress) {
      take(frame_, arrived_.arrived(frames));
    }
  }
  if (ended) socket_.reset();  // the daemon is gone; tend() connects to the next one
  return static_cast<int>(frames);
}

void HubLink::send(const Frame* first, std::size_t count) {
  not_sent_ += socket_.is_open() ? to_send_.send(socket_.get(), first, count).not_sent : count;
}

void HubLink::tend() {
  if (socket_.is_open()) return;
  try {
    connect();
  } catch (const LinkError&) {  // still no daemon; the next call tries again
  }
}

}  // namespace adhoc_communication
