#include "radio/port.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>

#include "link/ethernet.hpp"
#include "link/steady_now.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kLargestFrame = 4096;
constexpr std::size_t kLongestName = 64;

}  // namespace

std::optional<std::string> HubPort::receive_name() {
  std::array<char, kLongestName + 1> name;
  const ssize_t size = recv(socket_.get(), name.data(), name.size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return std::nullopt;
  if (size <= 0 || static_cast<std::size_t>(size) > kLongestName) return "";
  return std::string(name.data(), static_cast<std::size_t>(size));
}

void HubPort::receive(const FrameTaker& take) {
  std::array<std::uint8_t, kLargestFrame> buffer;
  for (int frames = 0; frames < Link::kMostAtOnce;) {
    const ssize_t size = recv(socket_.get(), buffer.data(), buffer.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) return;
    if (size <= 0) return socket_.reset();
    ++frames;
    if (const auto frame = from_wire(buffer.data(), static_cast<std::size_t>(size))) take(*frame, steady_now());
  }
}

void HubPort::send(const Frame& frame) {
  const Bytes octets = to_wire(frame);
  ::send(socket_.get(), octets.data(), octets.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace adhoc_communication
