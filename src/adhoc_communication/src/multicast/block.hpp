// One block of a group packet at one robot: what has arrived of it, and what can be made from that.
#pragma once

#include <bitset>
#include <map>
#include <vector>

#include "multicast/erasure_code.hpp"

namespace adhoc_communication::multicast {

/// Blocks up to so many frames are repaired by repetition.
constexpr int kMostRepeatedFrames = 3;

/// The frames lie one behind the other in the packet's octets, padded with zeros to equal length.
class Block {
 public:
  /// `octets`: room for frames x length octets, owned by the packet and staying where it is.
  Block(std::uint8_t* octets, int frames, std::size_t length) : octets_(octets), frames_(frames), length_(length) {}

  int frames() const { return frames_; }
  bool complete() const { return static_cast<int>(present_.count()) == frames_; }
  /// Symbols that it still takes to complete the block.
  int missing() const { return complete() ? 0 : frames_ - static_cast<int>(present_.count() + parities_.size()); }
  /// Symbols missing; of a block of few frames a bit for each missing frame.
  std::uint8_t missing_for_report() const;
  bool has_frame(int frame) const { return present_.test(static_cast<std::size_t>(frame)); }

  /// All frames are in place already.
  void fill() {
    for (int frame = 0; frame < frames_; ++frame) present_.set(static_cast<std::size_t>(frame));
  }
  /// True when the symbol was of use. The frames that it makes computable are computed.
  bool take(int symbol, const Bytes& octets);
  /// The octets of a symbol; the block has to be complete for parity, or to have the frame.
  Bytes symbol(int symbol) const;

 private:
  std::uint8_t* at(int frame) const { return octets_ + static_cast<std::size_t>(frame) * length_; }
  void solve();

  std::uint8_t* octets_;
  int frames_;
  std::size_t length_;
  std::bitset<kMostFramesOfBlock> present_;
  std::map<int, Bytes> parities_;
};

}  // namespace adhoc_communication::multicast
