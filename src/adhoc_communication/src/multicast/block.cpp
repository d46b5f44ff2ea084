#include "multicast/block.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {

bool Block::take(int symbol, const Bytes& octets) {
  if (complete() || octets.size() > length_ || symbol < 0 || symbol >= kSymbols) return false;
  if (symbol < frames_) {
    if (has_frame(symbol)) return false;
    std::copy(octets.begin(), octets.end(), at(symbol));
    present_.set(static_cast<std::size_t>(symbol));
  } else {
    if (octets.size() != length_ || !parities_.emplace(symbol, octets).second) return false;
  }
  if (!complete() && missing() <= 0) solve();
  if (complete()) parities_.clear();
  return true;
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
  for (const auto& [symbol, octets] : parities_) {
    if (parities.size() < missing.size()) parities.push_back({symbol, octets.data()});
  }
  const std::vector<Bytes> recovered = recover(frames, length_, parities);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    std::copy(recovered[i].begin(), recovered[i].end(), at(missing[i]));
  }
  fill();
}

Bytes Block::symbol(int symbol) const {
  if (symbol < frames_) return Bytes(at(symbol), at(symbol) + length_);
  std::vector<const std::uint8_t*> frames;
  for (int frame = 0; frame < frames_; ++frame) frames.push_back(at(frame));
  return parity(frames, length_, symbol);
}

}  // namespace adhoc_communication::multicast
