// Groups as their members and roots see them: who belongs to them, what is sent to them, what is said about it.
//
// Whoever calls takes letters, ends and changes afterwards.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "multicast/copy_queue.hpp"
#include "multicast/distributor.hpp"
#include "multicast/group_sends.hpp"
#include "multicast/memberships.hpp"
#include "multicast/own_group.hpp"
#include "transport/sending.hpp"

namespace adhoc_communication::multicast {

/// A packet for one robot; its end comes back as an argument of ended().
struct Letter {
  transport::Sending sending;
  transport::Image image;
};

/// A send of the host to a group has ended.
struct GroupSendEnd {
  SendId id;
  bool delivered;
  std::string reason;
  std::vector<std::string> missed{};  ///< members that it has not reached
};

class GroupTraffic {
 public:
  /// `room`: octets for the members in one activation. `automatic`: every robot's group is joined.
  GroupTraffic(const Identity& self, std::size_t room, bool automatic, const routing::RobotDirectory& directory,
               const routing::Router& router, Distributor& distributor)
      : self_(self),
        directory_(directory),
        router_(router),
        distributor_(distributor),
        own_group_(room),
        memberships_(directory, router.request_load(), automatic, own_group_.most()) {}

  // The host.
  void join(const std::string& group);
  void leave(const std::string& group);
  /// `lifetime`: 0: none.
  void send(SendId id, const std::string& group, const transport::Image& image, Priority priority, Time lifetime,
            Time now);
  /// Puts another packet in the place of one that waits. False if there is no such packet.
  bool replace(SendId former, SendId id, const std::string& group, const transport::Image& image, Time lifetime,
               Time now);
  /// Returns the members that it has not reached; copies that are on their way are not among them.
  std::vector<std::string> cancel(SendId id, const std::string& group);

  // Robots come and go.
  void appeared(const std::string& robot, wire::BootTag boot, Time now);
  void lost(const std::string& robot, wire::BootTag boot, Time now);

  /// A packet about groups. False if it is malformed.
  /// `boot`: of the run of `source` that has sent it.
  bool take(const std::string& source, wire::BootTag boot, const transport::Packet& packet, Time now);
  /// What became of a letter.
  void ended(const transport::Sending& letter, bool delivered, const std::string& reason, Time now);
  /// What became of packets of the own group at its members.
  void take_member_ends();
  /// What has waited for too long; to be called a few times a second.
  void expire(Time now);

  std::vector<Letter> take_letters() { return std::exchange(letters_, {}); }
  std::vector<GroupSendEnd> take_ends() { return std::exchange(ends_, {}); }
  std::vector<GroupChangeFinished> take_changes() { return std::exchange(changes_, {}); }

  /// Whether packets of the group of that robot are for this one.
  bool takes_part(const MacAddress& root) const;
  /// Whether the root of the group has taken this robot in.
  bool is_member_of(const MacAddress& root) const;
  /// The host has left it: its packets are not wanted.
  bool refuses(const std::string& group) const { return memberships_.refuses(group); }

  GroupState state(const std::string& group, Time now) const;
  std::vector<std::string> groups() const;
  const OwnGroup& own_group() const { return own_group_; }
  const Memberships& memberships() const { return memberships_; }

  /// The run ends: so do the changes that the host waits for.
  void end(const std::string& reason);
  /// What the host wanted of a former run.
  void succeed(const GroupTraffic& former) { memberships_.succeed(former.memberships_); }

 private:
  void carry_out_memberships();
  void write(transport::Sending sending, transport::PacketKind kind, Bytes payload);
  void ask_for_members(const std::string& group);

  // group_root.cpp: the own group.
  bool floods(std::size_t octets, Priority priority) const;
  void send_to_own(SendId id, const transport::Image& image, Priority priority, Time lifetime, Time now);
  bool replace_in_own(SendId former, SendId id, const transport::Image& image, Time lifetime, Time now);
  /// `was_away`: that run was a member before, and has only not been heard.
  void admit(const std::string& robot, wire::BootTag boot, bool was_away, Time now);
  void leave_out(const std::string& robot, const std::string& reason, Time now);
  void name_members(const std::string& robot);
  void send_copy(const std::string& robot, const HeldPacket& packet, transport::Purpose purpose, SendId parent);
  void start_copies();
  bool has_arrived(const WaitingCopy& copy) const;
  void drop_copy(const WaitingCopy& copy);
  void copy_ended(const std::string& member, std::uint8_t stream, std::uint32_t number);
  void copy_finished(const transport::Sending& copy);
  void part_finished(SendId parent, const std::string& member, bool delivered, const std::string& reason);

  bool take_copy(const std::string& source, const transport::Packet& packet, Time now);
  void members_named(const std::string& group, const std::vector<std::string>& members, Time now);
  void send_to_each(const WaitingSend& send, const std::vector<std::string>& members);
  void fail_waiting(const std::string& group, const std::string& reason);

  // group_state.cpp
  const Tree* tree_of(const MacAddress& root) const;
  std::set<MacAddress> ways_to_members(Time now) const;
  GroupState state_of_own(Time now) const;

  const Identity& self_;
  const routing::RobotDirectory& directory_;
  const routing::Router& router_;
  Distributor& distributor_;
  OwnGroup own_group_;
  CopyQueue copies_;
  Memberships memberships_;
  GroupSends sends_;
  std::vector<Letter> letters_;
  std::vector<GroupSendEnd> ends_;
  std::vector<GroupChangeFinished> changes_;
};

}  // namespace adhoc_communication::multicast
