#include "multicast/block.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {

void Block::fill(const std::uint8_t* begin, const std::uint8_t* end) {
  reserve();
  std::fill(std::copy(begin, end, octets_.begin()), octets_.end(), std::uint8_t{0});
  for (int frame = 0; frame < frames_; ++frame) present_.set(static_cast<std::size_t>(frame));
  parities_.clear();
}

bool Block::take(int symbol, const Bytes& octets) {
  if (complete() || octets.size() > length_ || symbol < 0 || symbol >= kSymbols) return false;
  if (symbol < frames_) {
    if (has_frame(symbol)) return false;
    take_frame(symbol, octets);
  } else if (!take_parity(symbol, octets)) {
    return false;
  }
  if (!complete() && missing() <= 0) solve();
  return true;
}

/// Parity that lies in its place goes to another one: the block misses more frames than it has parity.
void Block::take_frame(int frame, const Bytes& octets) {
  reserve();
  present_.set(static_cast<std::size_t>(frame));
  for (auto& [symbol, place] : parities_) {
    if (place != frame) continue;
    place = free_place();
    std::copy_n(at(frame), length_, at(place));
  }
  std::fill(std::copy(octets.begin(), octets.end(), at(frame)), at(frame) + length_, std::uint8_t{0});
}

bool Block::take_parity(int symbol, const Bytes& octets) {
  if (octets.size() != length_ || parities_.count(symbol) != 0) return false;
  reserve();
  const int place = free_place();
  parities_[symbol] = place;
  std::copy(octets.begin(), octets.end(), at(place));
  return true;
}

/// Of a missing frame; no parity lies there.
int Block::free_place() const {
  std::bitset<kMostFramesOfBlock> taken = present_;
  for (const auto& [symbol, place] : parities_) taken.set(static_cast<std::size_t>(place));
  int place = 0;
  while (taken.test(static_cast<std::size_t>(place))) ++place;
  return place;
}

std::uint8_t Block::missing_for_report() const {
  if (frames_ > kMostRepeatedFrames) return static_cast<std::uint8_t>(missing());
  int bits = 0;
  for (int frame = 0; frame < frames_; ++frame) bits |= has_frame(frame) ? 0 : 1 << frame;
  return static_cast<std::uint8_t>(bits);
}

void Block::solve() {
  std::vector<const std::uint8_t*> frames;
  std::vector<int> missing;
  for (int frame = 0; frame < frames_; ++frame) {
    frames.push_back(has_frame(frame) ? at(frame) : nullptr);
    if (!has_frame(frame)) missing.push_back(frame);
  }
  std::vector<ParitySymbol> parities;
  for (const auto& [symbol, place] : parities_) parities.push_back({symbol, at(place)});
  const std::vector<Bytes> recovered = recover(frames, length_, parities);
  parities_.clear();
  for (std::size_t i = 0; i < missing.size(); ++i) take_frame(missing[i], recovered[i]);
}

Bytes Block::symbol(int symbol) const {
  if (symbol < frames_) return Bytes(at(symbol), at(symbol) + length_);
  std::vector<const std::uint8_t*> frames;
  for (int frame = 0; frame < frames_; ++frame) frames.push_back(at(frame));
  return parity(frames, length_, symbol);
}

}  // namespace adhoc_communication::multicast
