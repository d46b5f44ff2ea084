// What carries the frames of a robot: a network interface or a socket.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// One sentence for people that names the interface and the remedy.
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Is given a frame that lives until the call returns, and when it arrived by the steady clock.
using FrameTaker = std::function<void(const Frame& frame, Time arrived)>;

/// Frames may be lost, never altered. A link that breaks comes back by itself: tend() tries to reopen it.
class Link {
 public:
  static constexpr int kMostAtOnce = 64;  ///< frames of one receive(), so that timers are served while frames pour in

  virtual ~Link() = default;

  /// Readable when receive() may have a frame; -1 while the link is broken.
  virtual int descriptor() const = 0;
  /// Hands over what has arrived for this address or for all, without waiting. Returns how many frames it read, also
  /// those for others; kMostAtOnce when more may be there.
  virtual int receive(const FrameTaker& take) = 0;
  /// In this order, without waiting; each frame that cannot be sent now is lost and counted, the others are sent.
  virtual void send(const Frame* first, std::size_t count) = 0;
  void send(const Frame& frame) { send(&frame, 1); }
  /// Whether something of what was sent is still in the device: the radio has not got rid of it. False where nobody can
  /// tell.
  virtual bool keeps_frames() const { return false; }
  /// Looks after the link; call it about once a second.
  virtual void tend() = 0;

  virtual bool is_up() const = 0;
  /// One sentence on why it is not up, where more is known than that.
  virtual std::string trouble() const { return {}; }
  virtual MacAddress address() const = 0;             ///< tend() may find another one
  virtual int mtu() const = 0;                        ///< octets behind the Ethernet header; the same
  virtual std::uint64_t frames_not_sent() const = 0;  ///< that the link did not take
  /// That arrived while the link had no room for them.
  virtual std::uint64_t frames_missed() const { return 0; }
};

/// `interface` is the name of a network interface, or hub:/path of a hub socket. `address` overrides that of the
/// interface; with none of its own (lo, hub) it is derived from the robot's name. Throws LinkError.
std::unique_ptr<Link> open_link(const std::string& interface, std::optional<MacAddress> address,
                                const std::string& robot_name);

}  // namespace adhoc_communication
