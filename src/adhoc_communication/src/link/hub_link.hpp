// Frames through the Unix socket of a radio daemon, for machines that grant no raw sockets.
#pragma once

#include <string>
#include <vector>

#include "link/file_descriptor.hpp"
#include "link/link.hpp"

namespace adhoc_communication {

/// A SOCK_SEQPACKET client. The first message names the robot; every further one is a frame with its Ethernet header.
class HubLink : public Link {
 public:
  HubLink(std::string path, std::optional<MacAddress> address, std::string robot_name);

  int descriptor() const override { return socket_.get(); }
  std::optional<Frame> receive() override;
  void send(const Frame& frame) override;
  void tend() override;
  bool is_up() const override { return socket_.is_open(); }
  MacAddress address() const override { return address_; }
  int mtu() const override { return 2304; }

 private:
  void connect();

  std::string path_;
  std::string robot_name_;
  MacAddress address_{};
  FileDescriptor socket_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace adhoc_communication
