// Groups mc_<robot>: who belongs to the own one, which ones this robot belongs to.
//
// The robot a group is named after is its root and the only one that knows its members. Its packets go along a tree; a
// member that is not the root asks the root for the members and sends one reliable unicast to each.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "transport/packet_image.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

constexpr char kPrefix[] = "mc_";

inline std::string group_of(const std::string& robot) { return kPrefix + robot; }
/// The robot that a group is named after; nothing if the name is not that of a group.
std::optional<std::string> root_of(const std::string& group);

struct Membership {
  bool joined = false;
  bool joining = false;              ///< a join is on its way to the root
  bool asked_by_host = false;        ///< the end of the change has to be reported
  std::optional<Time> confirmed_by;  ///< a join that the host has asked for: when the root has to have named this robot
  bool leaving = false;              ///< a leave is on its way to the root
  bool left = false;                 ///< the leave has arrived; remembered, so that nobody joins again by himself
  bool turned_away = false;          ///< the root has said so before the join was acknowledged
  bool wanted = true;                ///< false once the host has left
  Time retry_at{0};                  ///< when to ask again after a failure
};

/// A packet waiting to learn to whom it goes.
struct WaitingSend {
  SendId id = 0;
  transport::Image image;
  Priority priority = Priority::kNormal;
  Time give_up{0};
};

/// A packet of the own group, kept for members that come late or come back.
struct HeldPacket {
  std::uint8_t stream = 0;
  std::uint32_t number = 0;
  transport::Image image;
  Time sent{0};
  Time until = Time::max();  ///< when it is of no use any more
};

/// A packet on its way to several members.
struct FanOut {
  std::size_t open = 0;
  std::vector<std::string> failures;  ///< one sentence for each member not reached
  HeldPacket packet;                  ///< of the own group
};

/// How a member of the own group is served.
struct Member {
  std::size_t copies = 0;  ///< packets on their way to it by themselves; while there are any, the tree leaves it out
};

struct Groups {
  static constexpr std::size_t kMostMembers = wire::kMostMembersOfActivation;
  static constexpr std::size_t kMostGroups = 1024;
  static constexpr Time kHeld = std::chrono::seconds(5);
  static constexpr std::size_t kMostHeldOctets = 4'000'000;
  static constexpr std::size_t kMostHeld = 256;
  static constexpr Time kRetry = std::chrono::seconds(2);
  static constexpr Time kFullRetry = std::chrono::seconds(30);  ///< after the root had no room for this robot
  static constexpr Time kMembersPatience = std::chrono::seconds(5);

  std::map<std::string, Member> members;        ///< of the own group, without this robot
  std::map<std::string, wire::BootTag> absent;  ///< members that fell silent, and their run
  std::deque<HeldPacket> held;
  std::map<std::string, Membership> memberships;  ///< by group, of other robots' groups
  std::map<SendId, FanOut> fan_outs;
  std::map<std::string, std::vector<WaitingSend>> waiting;  ///< by group

  /// Puts another packet in the place of one that waits. False if there is no such packet.
  bool replace_waiting(const std::string& group, SendId former, SendId id, const transport::Image& image);
  void drop_waiting(const std::string& group, SendId id);
};

/// Notes a packet, and forgets those that are too old or too many.
void hold(std::deque<HeldPacket>& held, HeldPacket packet, Time now);

/// The payload of a packet of kind kGroupCopy.
Bytes encode_copy(const HeldPacket& packet);
struct Copy {
  std::uint8_t stream;
  std::uint32_t number;
  Bytes image;
};
std::optional<Copy> decode_copy(const Bytes& payload);

Bytes encode_members(const std::set<std::string>& members);
/// Nothing if malformed.
std::optional<std::vector<std::string>> decode_members(const Bytes& payload);

}  // namespace adhoc_communication::multicast
