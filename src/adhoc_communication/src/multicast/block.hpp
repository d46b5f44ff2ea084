// One block of a group packet at one robot: what has arrived of it, and what can be made from that.
#pragma once

#include <bitset>
#include <map>
#include <vector>

#include "multicast/erasure_code.hpp"

namespace adhoc_communication::multicast {

/// Blocks up to so many frames are repaired by repetition.
constexpr int kMostRepeatedFrames = 3;

/// Frames are padded with zeros to equal length. A block takes its memory with its first symbol, and never more than
/// its frames have: parity lies where frames are missing.
class Block {
 public:
  Block(int frames, std::size_t length) : frames_(frames), length_(length) {}

  int frames() const { return frames_; }
  bool complete() const { return static_cast<int>(present_.count()) == frames_; }
  /// Symbols that it still takes to complete the block.
  int missing() const { return complete() ? 0 : frames_ - static_cast<int>(present_.count() + parities_.size()); }
  /// Symbols missing; of a block of few frames a bit for each missing frame.
  std::uint8_t missing_for_report() const;
  bool has_frame(int frame) const { return present_.test(static_cast<std::size_t>(frame)); }

  /// All frames at once, one behind the other; the last one may be shorter.
  void fill(const std::uint8_t* begin, const std::uint8_t* end);
  /// True when the symbol was of use. The frames that it makes computable are computed.
  bool take(int symbol, const Bytes& octets);
  /// The octets of a symbol; the block has to be complete for parity, or to have the frame.
  Bytes symbol(int symbol) const;
  /// All frames, one behind the other; nothing before the first symbol.
  const Bytes& octets() const { return octets_; }

 private:
  const std::uint8_t* at(int frame) const { return octets_.data() + static_cast<std::size_t>(frame) * length_; }
  std::uint8_t* at(int frame) { return octets_.data() + static_cast<std::size_t>(frame) * length_; }
  void reserve() { octets_.resize(static_cast<std::size_t>(frames_) * length_); }
  void take_frame(int frame, const Bytes& octets);
  bool take_parity(int symbol, const Bytes& octets);
  int free_place() const;
  void solve();

  int frames_;
  std::size_t length_;
  std::bitset<kMostFramesOfBlock> present_;
  Bytes octets_;
  std::map<int, int> parities_;  ///< by symbol: the place of the missing frame where it lies
};

}  // namespace adhoc_communication::multicast
