#include "multicast/group_packet.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {
namespace {

struct Cut {
  std::size_t length;  ///< of a symbol
  std::size_t frames;
  std::size_t blocks;
};

Cut cut(std::uint32_t total, std::uint16_t segment_size) {
  const std::size_t length = std::min<std::size_t>(segment_size, total);
  const std::size_t frames = (total + length - 1) / length;
  return {length, frames, (frames + kMostFramesOfBlock - 1) / kMostFramesOfBlock};
}

}  // namespace

std::size_t GroupPacket::count_blocks(std::uint32_t total, std::uint16_t segment_size) {
  return cut(total, segment_size).blocks;
}

GroupPacket::GroupPacket(std::uint32_t total, std::uint16_t segment_size) : total_(total), segment_size_(segment_size) {
  const auto [length, frames, count] = cut(total, segment_size);
  length_ = length;
  last_length_ = total - (frames - 1) * length;
  for (std::size_t block = 0; block < count; ++block) {
    blocks_.emplace_back(static_cast<int>(frames / count + (block < frames % count ? 1 : 0)), length);
  }
  open_blocks_ = count;
}

GroupPacket::GroupPacket(const Bytes& image, std::uint16_t segment_size)
    : GroupPacket(static_cast<std::uint32_t>(image.size()), segment_size) {
  fill(image);
}

bool GroupPacket::fill(const Bytes& image) {
  if (image.size() != total_) return false;
  const std::uint8_t* begin = image.data();
  for (Block& block : blocks_) {
    const std::size_t left = static_cast<std::size_t>(image.data() + image.size() - begin);
    const std::uint8_t* end = begin + std::min(static_cast<std::size_t>(block.frames()) * length_, left);
    block.fill(begin, end);
    begin = end;
  }
  open_blocks_ = 0;
  return true;
}

Bytes GroupPacket::image() const {
  Bytes image;
  image.reserve(total_ + length_);
  for (const Block& block : blocks_) image.insert(image.end(), block.octets().begin(), block.octets().end());
  image.resize(total_);
  return image;
}

bool GroupPacket::is_last_frame(std::size_t block, int symbol) const {
  return block + 1 == blocks_.size() && symbol + 1 == blocks_[block].frames();
}

bool GroupPacket::take(std::size_t block, int symbol, const Bytes& octets) {
  if (block >= blocks_.size()) return false;
  const bool full = octets.size() == length_;
  const bool last = is_last_frame(block, symbol) && octets.size() == last_length_;
  if (!full && !last) return false;
  const bool was_complete = blocks_[block].complete();
  if (!blocks_[block].take(symbol, octets)) return false;
  if (!was_complete && blocks_[block].complete()) --open_blocks_;
  return true;
}

Bytes GroupPacket::symbol(std::size_t block, int symbol) const {
  Bytes octets = blocks_[block].symbol(symbol);
  if (is_last_frame(block, symbol)) octets.resize(last_length_);
  return octets;
}

}  // namespace adhoc_communication::multicast
