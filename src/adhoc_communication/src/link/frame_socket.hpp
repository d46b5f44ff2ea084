// Many frames by one system call, in and out of a socket that keeps the boundaries of messages.
#pragma once

#include <sys/socket.h>
#include <time.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "link/ethernet.hpp"

namespace adhoc_communication {

/// The messages of one system call.
class ReceiveBatch {
 public:
  ReceiveBatch(std::size_t largest_message, std::size_t most_messages);

  /// What has arrived, without waiting. Returns the number of messages; 0 with errno when there is none.
  std::size_t fill(int descriptor);
  const std::uint8_t* octets(std::size_t index) const { return &room_[index * distance_]; }
  std::size_t size(std::size_t index) const { return messages_[index].msg_len; }
  /// By the steady clock. When it is read, unless the socket has the option SO_TIMESTAMPNS.
  Time arrived(std::size_t index) const;

 private:
  struct Control {
    alignas(struct cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(struct timespec))> octets;
  };

  std::size_t distance_;                  ///< between the beginnings of two messages
  std::unique_ptr<std::uint8_t[]> room_;  ///< not initialised: pages that no message reaches take no memory
  std::vector<struct iovec> parts_;
  std::vector<Control> controls_;
  std::vector<struct mmsghdr> messages_;
  std::size_t filled_ = 0;
  Time read_at_{0};
  std::chrono::nanoseconds unix_time_at_read_{0};
};

struct SendOutcome {
  std::size_t not_sent = 0;
  int error = 0;  ///< errno of the last frame that was not sent
};

/// Frames with their Ethernet headers, straight from where they are.
class SendBatch {
 public:
  static constexpr std::size_t kMostAtOnce = 64;  ///< frames of one system call

  SendBatch();
  /// Without waiting. `remote` goes with each message; none for a connected socket. A frame that is refused keeps none
  /// of the others back.
  SendOutcome send(int descriptor, const Frame* first, std::size_t count, struct sockaddr* remote = nullptr,
                   socklen_t remote_size = 0);

 private:
  void prepare(std::size_t index, const Frame& frame);

  std::vector<EthernetHeader> headers_;
  std::vector<struct iovec> parts_;  ///< two of each frame
  std::vector<struct mmsghdr> messages_;
};

}  // namespace adhoc_communication
