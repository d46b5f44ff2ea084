// Groups mc_<robot>: who belongs to the own one, which ones this robot belongs to.
//
// The robot a group is named after is its root and the only one that knows its members. A packet for the group is one
// reliable unicast per member; a member that is not the root asks the root for the members first.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication::multicast {

constexpr char kPrefix[] = "mc_";

inline std::string group_of(const std::string& robot) { return kPrefix + robot; }
/// The robot that a group is named after; nothing if the name is not that of a group.
std::optional<std::string> root_of(const std::string& group);

struct Membership {
  bool joined = false;
  bool joining = false;        ///< a join is on its way to the root
  bool asked_by_host = false;  ///< the end of the change has to be reported
  bool wanted = true;          ///< false once the host has left
  Time retry_at{0};            ///< when to ask again after a failure
};

/// A packet waiting to learn to whom it goes.
struct WaitingSend {
  SendId id = 0;
  transport::Image image;
  Priority priority = Priority::kNormal;
  Time give_up{0};
};

/// A packet on its way to several members.
struct FanOut {
  std::size_t open = 0;
  std::vector<std::string> failures;  ///< one sentence for each member not reached
};

struct Groups {
  static constexpr std::size_t kMostMembers = 1024;
  static constexpr std::size_t kMostGroups = 1024;
  static constexpr Time kRetry = std::chrono::seconds(2);
  static constexpr Time kMembersPatience = std::chrono::seconds(5);

  std::set<std::string> members;                  ///< of the own group, without this robot
  std::map<std::string, Membership> memberships;  ///< by group, of other robots' groups
  std::map<SendId, FanOut> fan_outs;
  std::map<std::string, std::vector<WaitingSend>> waiting;  ///< by group
};

Bytes encode_members(const std::set<std::string>& members);
/// Nothing if malformed.
std::optional<std::vector<std::string>> decode_members(const Bytes& payload);

}  // namespace adhoc_communication::multicast
