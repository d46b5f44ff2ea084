#include "link/frame_socket.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "link/steady_now.hpp"

namespace adhoc_communication {
namespace {

/// To a host that was away for longer, what it finds is new: it could not have answered.
constexpr Time kOldest = std::chrono::milliseconds(20);

/// Not a multiple of a page, so that the beginnings of messages do not drive each other out of the cache.
std::size_t apart(std::size_t largest_message) { return (largest_message + 4095) / 4096 * 4096 + 1600; }

}  // namespace

ReceiveBatch::ReceiveBatch(std::size_t largest_message, std::size_t most_messages)
    : distance_(apart(largest_message)),
      room_(new std::uint8_t[distance_ * most_messages]),
      parts_(most_messages),
      controls_(most_messages),
      messages_(most_messages) {
  for (std::size_t i = 0; i < most_messages; ++i) {
    parts_[i] = {&room_[i * distance_], largest_message};
    messages_[i].msg_hdr.msg_iov = &parts_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = controls_[i].octets.data();
    messages_[i].msg_hdr.msg_controllen = controls_[i].octets.size();
  }
}

std::size_t ReceiveBatch::fill(int descriptor) {
  for (std::size_t i = 0; i < filled_; ++i) messages_[i].msg_hdr.msg_controllen = controls_[i].octets.size();
  filled_ = 0;
  int count = 0;
  do {
    count = recvmmsg(descriptor, messages_.data(), static_cast<unsigned>(messages_.size()), MSG_DONTWAIT, nullptr);
  } while (count < 0 && errno == EINTR);
  if (count <= 0) return 0;
  filled_ = static_cast<std::size_t>(count);
  read_at_ = steady_now();
  unix_time_at_read_ = std::chrono::system_clock::now().time_since_epoch();
  return filled_;
}

/// The kernel's stamp is Unix time, which may be set between it and the reading.
Time ReceiveBatch::arrived(std::size_t index) const {
  const struct msghdr& message = messages_[index].msg_hdr;
  const struct cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header == nullptr || header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_TIMESTAMPNS) return read_at_;
  struct timespec stamp {};
  std::memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
  const Time age = unix_time_at_read_ - std::chrono::seconds(stamp.tv_sec) - Time(stamp.tv_nsec);
  return read_at_ - std::clamp(age, Time::zero(), kOldest);
}

SendBatch::SendBatch() : headers_(kMostAtOnce), parts_(2 * kMostAtOnce), messages_(kMostAtOnce) {
  for (std::size_t i = 0; i < kMostAtOnce; ++i) {
    parts_[2 * i] = {headers_[i].data(), headers_[i].size()};
    messages_[i].msg_hdr.msg_iov = &parts_[2 * i];
    messages_[i].msg_hdr.msg_iovlen = 2;
  }
}

void SendBatch::prepare(std::size_t index, const Frame& frame) {
  headers_[index] = ethernet_header(frame);
  parts_[2 * index + 1] = {const_cast<std::uint8_t*>(frame.bytes.data()), frame.bytes.size()};
}

SendOutcome SendBatch::send(int descriptor, const Frame* first, std::size_t count, struct sockaddr* remote,
                            socklen_t remote_size) {
  SendOutcome outcome;
  for (std::size_t begin = 0; begin < count; begin += kMostAtOnce) {
    const std::size_t size = std::min(kMostAtOnce, count - begin);
    for (std::size_t i = 0; i < size; ++i) {
      prepare(i, first[begin + i]);
      messages_[i].msg_hdr.msg_name = remote;
      messages_[i].msg_hdr.msg_namelen = remote_size;
    }
    for (std::size_t done = 0; done < size;) {
      const int sent =
          sendmmsg(descriptor, &messages_[done], static_cast<unsigned>(size - done), MSG_DONTWAIT | MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) {  // that is the first of them; after others it is refused anew, with its reason
        outcome.error = errno;
        ++outcome.not_sent;
      }
      done += static_cast<std::size_t>(std::max(sent, 1));
    }
  }
  return outcome;
}

}  // namespace adhoc_communication
