// A group packet at one robot, cut into blocks: empty at first where it is received, full where it starts.
#pragma once

#include <optional>
#include <vector>

#include "multicast/block.hpp"

namespace adhoc_communication::multicast {

/// Blocks have at most kMostFramesOfBlock frames and are as equal in length as can be. Memory grows by blocks, with
/// what arrives.
class GroupPacket {
 public:
  /// `total`: octets of the image.
  GroupPacket(std::uint32_t total, std::uint16_t segment_size);
  GroupPacket(const Bytes& image, std::uint16_t segment_size);
  GroupPacket(const GroupPacket&) = delete;
  GroupPacket& operator=(const GroupPacket&) = delete;

  /// Of a packet of `total` octets.
  static std::size_t count_blocks(std::uint32_t total, std::uint16_t segment_size);

  std::uint32_t total() const { return total_; }
  std::uint16_t segment_size() const { return segment_size_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  bool complete() const { return open_blocks_ == 0; }
  /// The packet has to be complete.
  Bytes image() const;

  /// All of it at once; false if the image has another size.
  bool fill(const Bytes& image);
  /// True when the symbol was of use.
  bool take(std::size_t block, int symbol, const Bytes& octets);
  /// The octets of a symbol as they go on the air: the last frame of the packet without padding.
  Bytes symbol(std::size_t block, int symbol) const;

 private:
  bool is_last_frame(std::size_t block, int symbol) const;

  std::uint32_t total_;
  std::uint16_t segment_size_;
  std::size_t length_ = 0;       ///< of a symbol
  std::size_t last_length_ = 0;  ///< of the last frame, without padding
  std::vector<Block> blocks_;
  std::size_t open_blocks_ = 0;
};

}  // namespace adhoc_communication::multicast
