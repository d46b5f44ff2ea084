// Frames through the Unix socket of a radio daemon, for machines that grant no raw sockets.
#pragma once

#include <string>

#include "link/file_descriptor.hpp"
#include "link/frame_socket.hpp"
#include "link/link.hpp"

namespace adhoc_communication {

/// A SOCK_SEQPACKET client. The first message names the robot; every further one is a frame with its Ethernet header.
class HubLink : public Link {
 public:
  HubLink(std::string path, std::optional<MacAddress> address, std::string robot_name);

  int descriptor() const override { return socket_.get(); }
  int receive(const FrameTaker& take) override;
  using Link::send;
  void send(const Frame* first, std::size_t count) override;
  void tend() override;
  bool is_up() const override { return socket_.is_open(); }
  MacAddress address() const override { return address_; }
  int mtu() const override { return 2304; }
  std::uint64_t frames_not_sent() const override { return not_sent_; }

 private:
  void connect();

  std::string path_;
  std::string robot_name_;
  MacAddress address_{};
  FileDescriptor socket_;
  std::uint64_t not_sent_ = 0;
  ReceiveBatch arrived_;
  SendBatch to_send_;
  Frame frame_;  ///< the one handed over
};

}  // namespace adhoc_communication
