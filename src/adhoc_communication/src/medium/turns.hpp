// One channel on which an invisible hand gives turns: frames that disturb each other nowhere share one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// A frame does not begin while its sender sends or receives, while somebody who hears the sender receives, or while a
/// receiver sends or hears another. Turns are given in the order of the calls; one once given is not put off.
class Turns {
 public:
  using Node = std::size_t;

  struct Listener {
    Node node;
    bool receives;  ///< the frame is for it; otherwise it only hears it
  };

  void add_node() { nodes_.emplace_back(); }
  /// When a frame that these hear may begin.
  Time next(Node sender, const std::vector<Listener>& listeners, Time now) const {
    Time begin = std::max({now, nodes_[sender].sends, nodes_[sender].receives});
    for (const Listener& listener : listeners) {
      const Until& until = nodes_[listener.node];
      begin = std::max(begin, listener.receives ? std::max(until.sends, until.hears) : until.receives);
    }
    return begin;
  }
  /// It is on the air until `end`.
  void take(Node sender, const std::vector<Listener>& listeners, Time end) {
    nodes_[sender].sends = end;
    for (const Listener& listener : listeners) {
      Until& until = nodes_[listener.node];
      until.hears = std::max(until.hears, end);
      if (listener.receives) until.receives = std::max(until.receives, end);
    }
  }

 private:
  struct Until {
    Time sends{0};
    Time hears{0};  ///< whatever it is
    Time receives{0};
  };

  std::vector<Until> nodes_;
};

}  // namespace adhoc_communication
