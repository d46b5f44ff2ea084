// Where the frames of one robot enter and leave the radio.
#pragma once

#include <optional>
#include <string>

#include "adhoc_communication/types.hpp"
#include "link/file_descriptor.hpp"
#include "link/packet_socket_link.hpp"

namespace adhoc_communication {

class Port {
 public:
  virtual ~Port() = default;
  virtual int descriptor() const = 0;
  /// Hands over what the robot sent, without waiting; at most Link::kMostAtOnce frames, so that it keeps no other robot
  /// waiting.
  virtual void receive(const FrameTaker& take) = 0;
  virtual void send(const Frame& frame) = 0;
  /// False once the robot's end is gone for good.
  virtual bool is_open() const = 0;
};

/// The near end of a veth pair whose far end is the robot's interface.
class InterfacePort : public Port {
 public:
  InterfacePort(const std::string& interface, const std::string& robot) : link_(interface, std::nullopt, robot) {
    link_.hear_all();
  }
  int descriptor() const override { return link_.descriptor(); }
  void receive(const FrameTaker& take) override { link_.receive(take); }
  void send(const Frame& frame) override { link_.send(frame); }
  bool is_open() const override { return true; }

 private:
  PacketSocketLink link_;
};

/// A HubLink at the other end. Its first message is the name of the robot.
class HubPort : public Port {
 public:
  explicit HubPort(FileDescriptor socket) : socket_(std::move(socket)) {}
  int descriptor() const override { return socket_.get(); }
  void receive(const FrameTaker& take) override;
  void send(const Frame& frame) override;
  bool is_open() const override { return socket_.is_open(); }

  /// The name, once it has arrived. Empty when the client sent something else or left.
  std::optional<std::string> receive_name();

 private:
  FileDescriptor socket_;
};

}  // namespace adhoc_communication
