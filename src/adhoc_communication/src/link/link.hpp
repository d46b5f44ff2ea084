// What carries the frames of a robot: a network interface or a socket.
#pragma once

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

/// Frames may be lost, never altered. A link that breaks comes back by itself: tend() tries to reopen it.
class Link {
 public:
  virtual ~Link() = default;

  /// Readable when receive() may have a frame; -1 while the link is broken.
  virtual int descriptor() const = 0;
  /// The next frame for this address or for all, without waiting.
  virtual std::optional<Frame> receive() = 0;
  /// Without waiting; a frame that cannot be sent now is lost.
  virtual void send(const Frame& frame) = 0;
  /// Looks after the link; call it about once a second.
  virtual void tend() = 0;

  virtual bool is_up() const = 0;
  virtual MacAddress address() const = 0;
  virtual int mtu() const = 0;  ///< octets behind the Ethernet header
};

/// `interface` is the name of a network interface, or hub:/path of a hub socket. `address` overrides that of the
/// interface; with none of its own (lo, hub) it is derived from the robot's name. Throws LinkError.
std::unique_ptr<Link> open_link(const std::string& interface, std::optional<MacAddress> address,
                                const std::string& robot_name);

}  // namespace adhoc_communication
