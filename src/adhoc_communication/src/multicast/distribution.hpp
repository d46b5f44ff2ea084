// One group packet on its way from this robot to its children in the tree: what is sent next, who still misses what.
//
// Frames go out once; then the children are asked, and as many fresh parity symbols follow as the one that misses most
// needs, until all have all (of blocks up to 3 frames: the missing frames themselves). Each question closes a round,
// so that an answer is known to count everything sent before. Where that costs less air, a frame goes to each child by
// itself, several of them to one child after the other.
#pragma once

#include <bitset>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "multicast/carriage.hpp"
#include "multicast/child.hpp"
#include "multicast/group_packet.hpp"
#include "multicast/rounds.hpp"
#include "multicast/trials.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

class Distribution {
 public:
  static constexpr std::size_t kWindow = 4;  ///< blocks on their way at once
  static constexpr int kFramesPerQuestion = 48;
  /// The same while it is not known what a broadcast costs: at first, and then.
  static constexpr int kFramesOfFirstMeasure = 2;
  static constexpr int kFramesOfMeasure = 8;
  static constexpr int kFirstMeasures = 3;  ///< until one of which was answered with the cost
  static constexpr std::size_t kRun = 16;   ///< frames to one child, before the next child gets them
  static constexpr std::size_t kTrial = 2;  ///< the same to learn what that costs

  /// `first_parity`: where in the parity symbols to begin, so that neighbours that both send differ.
  Distribution(const GroupPacket& packet, transport::RoundTrip& round_trip, std::uint8_t first_parity);

  /// Children that are new, or all of them when the tree was built anew, may have any part of the packet.
  /// With each child the coverage of the members behind it; a child whose members have changed has to report anew.
  void set_children(const std::map<MacAddress, std::uint32_t>& children, bool anew, Time now);
  bool done() const;
  /// Some of it was sent.
  bool begun() const;
  /// The one child that still misses something, if it is one only.
  std::optional<MacAddress> only_open_child() const;

  struct Outgoing {
    std::size_t block;
    int symbol;
    bool question;
    std::uint16_t round;
    std::optional<MacAddress> child;  ///< nothing: it is for all of them
    bool again;                       ///< a repair
  };
  bool has_frame() const { return !run_.empty() || has_symbol(); }
  /// The next frame; has_frame() holds.
  Outgoing next(const Carriage& carriage, Time now);
  /// The round of a question without frame; such a question follows all frames sent.
  std::uint16_t question_round() { return rounds_.question(); }

  /// The answer of a child. True when all behind it have the packet.
  bool reported(const MacAddress& child, const wire::GroupReport& report, bool covers_all, Time now);
  /// Plans repairs whose answers are in or overdue. Returns the children to ask by themselves. `behind`: those that
  /// have not come to the end of an earlier packet, and so cannot have come to that of this one.
  std::vector<MacAddress> poll(const std::set<MacAddress>& behind, Time now);
  /// Adds the children that have not come to the end of it.
  void add_open(std::set<MacAddress>& children) const;
  /// Children without progress for too long.
  std::vector<MacAddress> stuck(Time now) const;
  Time next_deadline() const;

 private:
  struct Sent {
    std::bitset<kMostFramesOfBlock> frames;
    bool all = false;
    std::uint16_t round = 0;  ///< of the newest symbol, to whomever
    int next_parity = 0;
    std::size_t repairs_planned = 0;
  };
  struct Place {
    std::size_t block;
    int symbol;
    std::vector<MacAddress> targets;  ///< children that it is known to be of use to
  };
  bool has_symbol() const { return awaited_ == 0 && (!repairs_.empty() || next_unsent().has_value()); }
  std::optional<Place> next_unsent() const;
  Place next_symbol() const;
  void take_symbol(const Place& place);
  std::vector<MacAddress> takers(const Place& place) const;
  Way way(const Carriage& carriage, Time now) const;
  std::size_t frames_left() const;
  bool round_is_full() const;
  bool question_due(const Carriage& carriage, Time now) const;
  bool measures_at_first(const Carriage& carriage) const;
  void send_to_all(const Carriage& carriage, Time now);
  void send_to_each(const Carriage& carriage, std::size_t most, Time now);
  void close_run(Time now);
  void prune_run(Time now);
  bool open(std::size_t block) const;
  std::size_t window_end() const;
  bool nothing_to_come() const;
  void plan_repairs(std::size_t block, bool overdue);
  void repeat_frames(std::size_t block, const std::map<MacAddress, std::uint8_t>& missing);
  void fresh_parity(std::size_t block, const std::map<MacAddress, std::uint8_t>& missing);
  void plan_repair(Place place);

  const GroupPacket& packet_;
  Rounds rounds_;
  Trials trials_;
  std::uint8_t first_parity_;
  std::map<MacAddress, Child> children_;
  std::vector<Sent> sent_;
  std::vector<Place> repairs_;  ///< in reverse order
  std::deque<Outgoing> run_;    ///< decided, and on its way
  bool run_asks_ = false;       ///< the round is closed when all of them have gone
  int measures_ = 0;            ///< questions put early, to learn what a broadcast costs
  /// Answers that tell what a way costs; until they are in or overdue, nothing is sent.
  std::size_t awaited_ = 0;
};

}  // namespace adhoc_communication::multicast
