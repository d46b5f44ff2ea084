// Raw frames on a network interface (AF_PACKET). Needs the capability cap_net_raw, nothing else of root.
#pragma once

#include <string>

#include "link/file_descriptor.hpp"
#include "link/frame_socket.hpp"
#include "link/link.hpp"

namespace adhoc_communication {

class PacketSocketLink : public Link {
 public:
  PacketSocketLink(std::string interface, std::optional<MacAddress> address, const std::string& robot_name);

  int descriptor() const override { return socket_.get(); }
  int receive(const FrameTaker& take) override;
  using Link::send;
  /// Each frame goes to the queue of its access category (IEEE 802.11e); each category has a socket of its own.
  void send(const Frame* first, std::size_t count) override;
  bool keeps_frames() const override;
  void tend() override;
  bool is_up() const override { return up_; }
  std::string trouble() const override { return trouble_; }
  MacAddress address() const override { return address_; }
  int mtu() const override { return mtu_; }
  std::uint64_t frames_not_sent() const override { return not_sent_; }
  std::uint64_t frames_missed() const override { return missed_; }

  /// Every frame on the interface, whoever it is for; own frames are still left out. For the radio daemon.
  void hear_all() { hears_all_ = true; }

 private:
  void open();
  void read_interface();
  void count_missed();
  int socket_of(AccessCategory category) const;
  void send_by(int socket, const Frame* first, std::size_t count);
  bool concerns_us(const Frame& frame) const;

  std::string interface_;
  std::optional<MacAddress> given_address_;
  std::string robot_name_;
  FileDescriptor socket_;
  FileDescriptor video_socket_;  ///< sends only, as the next one
  FileDescriptor voice_socket_;
  MacAddress address_{};
  int index_ = 0;
  int mtu_ = 0;
  bool up_ = false;
  std::string trouble_;
  bool hears_all_ = false;
  std::uint64_t not_sent_ = 0;
  std::uint64_t missed_ = 0;
  ReceiveBatch arrived_;
  SendBatch to_send_;
  Frame frame_;  ///< the one handed over
};

}  // namespace adhoc_communication
