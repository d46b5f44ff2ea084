#include "multicast/group_packet.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {

GroupPacket::GroupPacket(std::uint32_t total, std::uint16_t segment_size)
    : total_(total), segment_size_(segment_size), length_(std::min<std::size_t>(segment_size, total)) {
  const std::size_t frames = (total + length_ - 1) / length_;
  const std::size_t count = (frames + kMostFramesOfBlock - 1) / kMostFramesOfBlock;
  octets_.resize(frames * length_);
  std::uint8_t* begin = octets_.data();
  for (std::size_t block = 0; block < count; ++block) {
    const std::size_t size = frames / count + (block < frames % count ? 1 : 0);
    blocks_.emplace_back(begin, static_cast<int>(size), length_);
    begin += size * length_;
  }
  open_blocks_ = count;
}

GroupPacket::GroupPacket(const Bytes& image, std::uint16_t segment_size)
    : GroupPacket(static_cast<std::uint32_t>(image.size()), segment_size) {
  fill(image);
}

bool GroupPacket::fill(const Bytes& image) {
  if (image.size() != total_) return false;
  std::copy(image.begin(), image.end(), octets_.begin());
  for (Block& block : blocks_) block.fill();
  open_blocks_ = 0;
  return true;
}

bool GroupPacket::is_last_frame(std::size_t block, int symbol) const {
  return block + 1 == blocks_.size() && symbol + 1 == blocks_[block].frames();
}

bool GroupPacket::take(std::size_t block, int symbol, const Bytes& octets) {
  if (block >= blocks_.size()) return false;
  const bool full = octets.size() == length_;
  const bool last = is_last_frame(block, symbol) && octets.size() == length_ - (octets_.size() - total_);
  if (!full && !last) return false;
  const bool was_complete = blocks_[block].complete();
  if (!blocks_[block].take(symbol, octets)) return false;
  if (!was_complete && blocks_[block].complete()) --open_blocks_;
  return true;
}

Bytes GroupPacket::symbol(std::size_t block, int symbol) const {
  Bytes octets = blocks_[block].symbol(symbol);
  if (is_last_frame(block, symbol)) octets.resize(length_ - (octets_.size() - total_));
  return octets;
}

}  // namespace adhoc_communication::multicast
