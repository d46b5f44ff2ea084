// The packets of the own group: which members each still has to reach, and by which way.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "multicast/branches.hpp"
#include "multicast/flood_times.hpp"
#include "multicast/tree_builder.hpp"

namespace adhoc_communication::multicast {

/// What became of a packet at one member.
struct MemberEnd {
  SendId id = 0;
  MacAddress member{};
  bool delivered = false;
  bool by_copy = false;  ///< the tree does not get it there: it has to be sent to this member by itself
  std::string reason;
  bool by_flood = false;  ///< it was flooded, and so others may be that are still on their way
};

/// Works on the own branch, which the callers hand over.
class Source {
 public:
  static constexpr int kMostRefusals = 2;       ///< of a member, before it is served by itself
  static constexpr std::size_t kFewFrames = 8;  ///< for which no way is looked for where the tree has failed
  static constexpr std::size_t kMostReceipts = wire::kMostMembersOfActivation * transport::kPriorities;
  static constexpr std::size_t kMostFlooded = 32;  ///< packets of one priority on their way; further ones take the tree
  static constexpr Time kMissed = std::chrono::milliseconds(200);  ///< a later one is there: time for it to come, too
  static constexpr Time kWaits = std::chrono::seconds(2);       ///< a flooded packet at a member, for those before it
  static constexpr Time kCopyTakes = std::chrono::seconds(10);  ///< so old, packets wait for none
  static constexpr Time kLeftOut = std::chrono::seconds(10);  ///< a tree that did not reach a member is given no other

  Source(std::uint16_t segment_size, std::uint8_t first_parity)
      : segment_size_(segment_size), first_parity_(first_parity) {}

  /// Before a packet: the tree reaches somebody no more, or there is none yet. To those that are on their way a new
  /// tree is a burden, so that each has to bear one only.
  bool wants_fresh_tree(const Branch& own) const;
  /// For a packet to `members`: all that the new tree has to reach, those to whom others are on their way among them.
  std::set<MacAddress> fresh_tree(const Branch& own, std::set<MacAddress> members, Time now);
  /// While packets are on their way: a new tree with these members. To be asked once.
  std::optional<std::set<MacAddress>> wants_tree_anew(const Branch& own, Time now);

  /// The number of the packet; one MemberEnd follows for each of `members`, who are in the tree.
  std::uint32_t start(Branch& own, SendId id, Priority priority, transport::Image image,
                      const std::set<MacAddress>& members, Time now);
  /// Not too many flooded packets of that priority are on their way.
  bool may_flood(const Branch& own, Priority priority) const;
  /// As start(), for a packet of one frame that everybody passes on.
  wire::GroupData start_flooded(Branch& own, SendId id, Priority priority, transport::Image image,
                                const std::set<MacAddress>& members, Time now);
  /// What a member has.
  void receipt(Branch& own, const wire::GroupReceipt& receipt, Time now);
  /// It has said so, of flooded packets.
  bool has_delivered(const MacAddress& member, std::uint8_t stream, std::uint32_t number) const;
  /// Another run of the member has none of it.
  void forget_receipts(const MacAddress& member);
  /// Ends flooded packets at members that have not said in time that they have them.
  void serve_late(Branch& own, Time now);
  Time next_late() const { return next_late_; }
  /// Puts another packet in the place of one not begun yet. Its number; nothing if it has begun, or does not await
  /// each of `members` on the tree: it went or goes to some by itself, or they joined later.
  std::optional<std::uint32_t> replace(Branch& own, SendId former, SendId id, const transport::Image& image,
                                       const std::set<MacAddress>& members, Time now);
  /// Members are to pass the packet over. Returns those that it has not reached.
  std::set<MacAddress> drop(Branch& own, SendId id);
  void drop_member(Branch& own, const MacAddress& member, const std::string& reason);
  /// All behind a child have it.
  void reached(Transfer& transfer, const std::set<MacAddress>& members);
  void left_over(Branch& own, const LeftOver& left_over, Time now);

  /// A packet goes to a member by itself: until that has ended, members are not told to pass it over.
  void copy_started(std::uint8_t stream, std::uint32_t number) { copies_[stream].insert(number); }
  void copy_finished(std::uint8_t stream, std::uint32_t number);
  /// As a receipt for it would say: all before it have come, or never will, and those that waited for it are delivered.
  void copy_arrived(Branch& own, const MacAddress& member, PacketNumber packet, Time now);
  /// The first packet that the tree or a copy still has to bring to somebody.
  std::uint32_t oldest_open(const Branch& own, std::uint8_t stream) const;

  /// Forgets packets whose members all have come to an end.
  static void remove_finished(Branch& own);
  std::vector<MemberEnd> take_ends() { return std::exchange(ends_, {}); }

 private:
  enum class Awaited { kNothing, kLittle, kMuch };

  static std::set<MacAddress> awaiting(const Branch& own);
  void reached_by_flood(Transfer& transfer, std::uint32_t number, const wire::GroupReceipt& receipt, Time now);
  void missed_by_flood(Transfer& transfer, std::uint32_t number, const wire::GroupReceipt& receipt, Time now);
  void hand_over(const MacAddress& member, PacketNumber packet);
  bool waits(const Transfer& transfer, const MacAddress& member, PacketNumber packet, Time now) const;
  void end_late(PacketNumber packet, Transfer& transfer, const std::set<MacAddress>& behind, Time now);
  void built(const Branch& own, const std::set<MacAddress>& members, Time now);

  void begin(Branch& own, Transfer& transfer, SendId id, transport::Image image, Time now);
  void finish_member(Transfer& transfer, const MemberEnd& end);
  static Awaited awaited(const Branch& own, const MacAddress& member);
  void refused_with_little(const MacAddress& member, Time now);
  void give_up(Branch& own, const MacAddress& member, bool by_copy, const std::string& reason);

  std::uint16_t segment_size_;
  std::uint8_t first_parity_;
  std::map<MacAddress, int> refusals_;
  bool build_anew_ = false;
  bool stale_ = false;  ///< the tree reaches somebody no more; the next packet gets a new one
  Time built_at_{0};
  std::array<std::uint32_t, transport::kPriorities> built_before_{};  ///< numbers of the first packets since then
  std::set<MacAddress> untried_;   ///< members with whom it was built, and to whom it has brought nothing so far
  std::set<MacAddress> left_out_;  ///< of these, those that it did not reach: another one would not, either
  /// Numbers on their way to members by themselves.
  std::array<std::multiset<std::uint32_t, routing::SequenceOrder>, transport::kPriorities> copies_;
  FloodTimes flood_times_;
  Time next_late_ = Time::max();
  using MemberStream = std::pair<MacAddress, std::uint8_t>;
  std::map<MemberStream, wire::GroupReceipt> receipts_;  ///< the latest
  std::map<MemberStream, std::uint32_t> handed_over_;    ///< the latest flooded packet that goes there by itself
  std::vector<MemberEnd> ends_;
};

}  // namespace adhoc_communication::multicast
