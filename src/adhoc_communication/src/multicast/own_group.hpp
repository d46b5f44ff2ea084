// The group of which this robot is the root: who belongs to it, and what is kept for members that come late.
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "multicast/groups.hpp"

namespace adhoc_communication::multicast {

class OwnGroup {
 public:
  static constexpr std::size_t kMostMembers = wire::kMostMembersOfActivation;
  static constexpr std::size_t kMostAbsent = kMostMembers;
  static constexpr Time kHeld = std::chrono::seconds(5);
  static constexpr std::size_t kMostHeldOctets = 4'000'000;
  static constexpr std::size_t kMostHeld = 256;
  static constexpr Time kPunctual = std::chrono::seconds(1);  ///< for a copy to arrive

  /// `room`: octets for the members in one activation, which has to name all.
  explicit OwnGroup(std::size_t room) : most_(std::min(kMostMembers, room / MacAddress{}.size())) {}

  std::size_t most() const { return most_; }
  std::size_t size() const { return members_.size(); }
  std::size_t absent() const { return absent_.size(); }
  bool holds(const std::string& robot) const { return members_.count(robot) != 0; }
  /// Without this robot.
  std::vector<std::string> names() const;

  enum class Admission { kFull, kKnown, kNew, kRestarted };
  /// `boot`: of the run that joins. A new run can be heard before the former one is known to be over.
  Admission admit(const std::string& robot, wire::BootTag boot);
  /// The robot has left: it is none and does not become one again by coming back. False if it was none.
  bool leave(const std::string& robot);
  /// A member that falls silent stays one as long as it runs: it need not have noticed. Of more than kMostAbsent the
  /// one lost longest ago is forgotten, and has to join again. False if that run was none.
  bool lose(const std::string& robot, wire::BootTag boot);
  /// A member of which nobody knows any more: as above.
  template <typename Predicate>
  void lose_if(const Predicate& is_unknown) {
    std::vector<std::pair<std::string, wire::BootTag>> unknown;
    for (const auto& [name, member] : members_) {
      if (is_unknown(name)) unknown.emplace_back(name, member.boot);
    }
    for (const auto& [name, boot] : unknown) lose(name, boot);
  }
  /// True for the run of a member that had been lost.
  bool comes_back(const std::string& robot, wire::BootTag boot);

  // Packets on their way to a member by themselves. Of one that is left out all are, which keeps them in order: a copy
  // says that nothing before it will come any more. As long as there are any the tree leaves it out, but for another
  // tree than that which they began with, if none of them is late: packets on the tree wait at the member for these. So
  // do flooded ones, which leave nobody out.
  void copy_started(const std::string& robot, const HeldPacket& packet);
  void copy_finished(const std::string& robot, std::uint8_t stream, std::uint32_t number);
  void leave_out(const std::string& robot);
  void take_back(const std::string& robot);
  bool served_by_copies(const std::string& robot) const;
  /// To be called for each packet.
  void take_back_punctual(Time now);
  void tree_built();

  /// Keeps a packet, and forgets those that are too old or too many.
  void hold(HeldPacket packet, Time now);
  /// Puts a packet in the place of the held one of the same number.
  void replace_held(const HeldPacket& packet);
  /// Packets that are still of use to a newcomer.
  std::vector<HeldPacket> held_for_newcomers(Time now) const;

 private:
  /// By stream and number; when each was sent first, by whatever way.
  using Copies = std::multimap<std::pair<std::uint8_t, std::uint32_t>, Time>;
  using Absent = std::deque<std::pair<std::string, wire::BootTag>>;

  Absent::iterator find_absent(const std::string& robot);
  void forget_absent(const std::string& robot);

  std::size_t most_;
  struct Member {
    wire::BootTag boot{};
    Copies copies{};         ///< on their way to it
    bool left_out = false;   ///< of the tree, because of these
    bool other_tree = true;  ///< there is another tree since then
  };
  std::map<std::string, Member> members_;
  Absent absent_;  ///< members that fell silent, and their run; the latest last
  std::deque<HeldPacket> held_;
};

}  // namespace adhoc_communication::multicast
