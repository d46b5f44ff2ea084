// One packet on its way to one robot, cut into segments.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "transport/packet_image.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

/// What has become of one segment.
struct SentSegment {
  Time sent{-1};
  Time first_sent{-1};
  int repetitions = 0;
  bool acknowledged = false;
  bool lost = false;  ///< waits to be repeated
  bool repeated = false;

  bool on_the_way() const { return !acknowledged && !lost; }
  void leaves(Time now);
};

struct OutgoingPacket {
  SendId id = 0;
  std::uint32_t number = 0;
  Image image;
  Time added{0};
  std::uint16_t segment_size = 0;
  std::vector<SentSegment> segments{};
  std::uint32_t started = 0;     ///< segments sent at least once
  std::uint32_t first_open = 0;  ///< every segment before is acknowledged
  std::uint8_t attempt = 0;
  std::optional<Time> refused_since{};  ///< the receiver has no room; one segment at a time asks for it
  bool begun = false;                   ///< some of it was sent, in whatever attempt
  bool dropped = false;                 ///< keeps its number until those before are finished
  bool arrives = false;                 ///< one of its longest segments has

  std::size_t unstarted() const { return segments.size() - started; }
  std::size_t longest() const { return dropped ? 0 : std::min<std::size_t>(image->size(), segment_size); }
  bool is_longest(std::uint32_t index) const { return index == 0 || index + 1 < segments.size(); }
  bool may_start() const { return unstarted() > 0 && (!refused_since || started == 0); }

  /// Into segments of another size; nothing of it has been sent then.
  void cut(std::uint16_t size);
  /// In the same segments, none of which has been sent then.
  void begin_anew();
  /// Nothing of it is to be sent any more.
  void drop();
  /// The message of one segment; source and destination, base and the wish for an acknowledgment are left to the
  /// caller.
  wire::Data data(std::uint8_t stream, std::uint32_t index) const;
  /// The open segments that the receiver says it has.
  std::vector<std::uint32_t> newly_received(const wire::PartialPacket& partial) const;
  /// Some may be acknowledged now.
  void pass_over_acknowledged();
};

}  // namespace adhoc_communication::transport
