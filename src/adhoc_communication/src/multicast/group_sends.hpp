// Sends to groups that have to reach several members, or wait to learn who the members are.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "multicast/groups.hpp"

namespace adhoc_communication::multicast {

/// A packet waiting to learn to whom it goes.
struct WaitingSend {
  SendId id = 0;
  transport::Image image;
  Priority priority = Priority::kNormal;
  Time give_up{0};
};

class GroupSends {
 public:
  // Members of a group of another robot are to be asked for first.
  /// True for the first that waits for this group: its root has to be asked.
  bool wait(const std::string& group, WaitingSend send);
  std::vector<WaitingSend> take_waiting(const std::string& group);
  /// Puts another packet in the place of one that waits. False if there is no such packet.
  bool replace_waiting(const std::string& group, SendId former, SendId id, const transport::Image& image);
  void drop_waiting(const std::string& group, SendId id);
  struct Overdue {
    std::vector<SendId> sends;
    std::vector<std::string> groups_to_ask;  ///< again, for those that came later
  };
  /// Each send has its own patience.
  Overdue take_overdue(Time now);

  // A packet on its way to several members.
  /// `packet`: of the own group.
  void fan_out(SendId id, std::size_t members, HeldPacket packet = {}) { fan_outs_[id] = {members, {}, packet}; }
  bool fans_out(SendId id) const { return fan_outs_.count(id) != 0; }
  const HeldPacket& packet_of(SendId id) const { return fan_outs_.at(id).packet; }
  void replace(SendId former, SendId id, const HeldPacket& packet);
  void drop(SendId id) { fan_outs_.erase(id); }
  /// Whom a packet has not reached.
  struct Missed {
    std::vector<std::string> members;
    std::string text;  ///< who, and why
  };
  /// One member's end. When it was the last one: whom the packet has not reached.
  std::optional<Missed> part_finished(SendId id, const std::string& member, bool delivered, const std::string& reason);

 private:
  struct FanOut {
    std::size_t open = 0;
    Missed missed;
    HeldPacket packet;
  };
  std::map<SendId, FanOut> fan_outs_;
  std::map<std::string, std::vector<WaitingSend>> waiting_;  ///< by group; none is empty
};

}  // namespace adhoc_communication::multicast
