// One channel that nobody divides: who is on the air, who senses it, which frames overlap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "medium/reach.hpp"

namespace adhoc_communication {

class ContendedChannel {
 public:
  using Node = std::size_t;
  using FrameId = std::uint64_t;

  /// The frames on the air overlap with this one, except those too far away to matter.
  void begin(FrameId frame, Node sender, Time start, Time end, const Reach& reach);
  /// Takes the frame off the air. Returns the senders of the frames that overlapped with it.
  std::vector<Node> end(FrameId frame);
  /// The sender goes down: its frame ends here.
  void silence(Node sender, Time now);
  /// When the frames that `listener` senses will have ended; `now` when it senses none. A frame that starts at this
  /// very moment cannot be sensed yet.
  Time sensed_until(Node listener, Time now, Reach& reach) const;

 private:
  struct Transmission {
    FrameId frame;
    Node sender;
    Time start;
    Time end;
    std::vector<Node> overlapping;
  };

  std::vector<Transmission> on_air_;
};

}  // namespace adhoc_communication
