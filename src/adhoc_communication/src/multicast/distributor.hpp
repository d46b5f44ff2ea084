// Packets for groups, along the trees of their roots: started at the root, passed on, put together, acknowledged.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "identity.hpp"
#include "multicast/transfer.hpp"
#include "multicast/tree.hpp"
#include "outbox.hpp"
#include "random.hpp"
#include "routing/router.hpp"
#include "transport/air_clock.hpp"
#include "transport/hop_sender.hpp"
#include "transport/reassembly.hpp"

namespace adhoc_communication::multicast {

/// A packet that has arrived here, be it to be passed on only: a member may get its packets as a relay of others.
struct Arrived {
  MacAddress root{};
  Bytes image;
  std::uint8_t hops = 1;
};

/// What became of a packet at one member.
struct MemberEnd {
  SendId id = 0;
  MacAddress member{};
  bool delivered = false;
  bool by_copy = false;  ///< the tree does not get it there: it has to be sent to this member by itself
  std::string reason;
};

/// A frame for all children, or for the only one that still misses something.
struct GroupFrame {
  MacAddress destination{};
  Bytes body;
};

class Distributor {
 public:
  static constexpr std::size_t kMostTrees = 1024;          ///< the one idle longest makes room
  static constexpr std::size_t kMostTransfers = 256;       ///< of one root and priority; further ones are not taken yet
  static constexpr std::uint32_t kPacketsAhead = 1 << 20;  ///< taken beyond what the root has finished
  static constexpr Time kIdleTree = std::chrono::seconds(60);
  static constexpr Time kIdleTransfer = std::chrono::seconds(20);
  static constexpr Time kReportJitter = std::chrono::milliseconds(1);
  static constexpr Time kActivationInterval = std::chrono::milliseconds(50);
  static constexpr Time kNoRoomInterval = std::chrono::milliseconds(50);  ///< between two words about it
  static constexpr int kMostRefusals = 2;               ///< of a member, before it is served by itself
  static constexpr std::size_t kMostChildrenTried = 2;  ///< for one member in one epoch
  static constexpr std::size_t kFewFrames = 8;          ///< for which no way is looked for where the tree has failed

  Distributor(const Identity& self, routing::Router& router, Outbox& outbox, Random& random, transport::AirClock& air,
              transport::Reassembly& reassembly, std::size_t largest_packet, std::uint16_t segment_size);
  ~Distributor();

  // At the root.
  /// Sends to `members` along the tree and returns the number of the packet; one MemberEnd follows for each.
  std::uint32_t start(SendId id, Priority priority, transport::Image image, const std::set<MacAddress>& members,
                      Time now);
  /// Puts another packet in the place of one not begun yet, for the same members. Its number; nothing if it has begun,
  /// or goes to members by itself as well.
  std::optional<std::uint32_t> replace(SendId former, SendId id, const transport::Image& image, Time now);
  /// Members are to pass the packet over. Returns those that it has not reached.
  std::set<MacAddress> drop(SendId id);
  /// The member has left or is lost.
  void drop_member(const MacAddress& member, const std::string& reason, Time now);
  /// A packet goes to a member by itself: until that has ended, members are not told to pass it over.
  void copy_started(std::uint8_t stream, std::uint32_t number);
  void copy_finished(std::uint8_t stream, std::uint32_t number);
  std::vector<MemberEnd> take_ends() { return std::exchange(ends_, {}); }

  // At every robot.
  /// `takes_part`: this run has joined the group, or is about to. A former run may have been a member.
  void on_activation(const MacAddress& from, const wire::GroupActivation& activation, bool takes_part, Time now);
  void on_refusal(const MacAddress& from, const wire::GroupRefusal& refusal, Time now);
  void on_data(const MacAddress& from, std::uint64_t counter, const wire::GroupData& data, Time now);
  void on_report(const MacAddress& from, const wire::GroupReport& report, Time now);
  /// The packet had to make room.
  void evicted(const transport::Reassembly::Key& key);
  /// A packet that came to this member by itself.
  void take_copy(const MacAddress& root, wire::BootTag boot, std::uint8_t stream, std::uint32_t number,
                 const Bytes& image, Time now);
  std::vector<Arrived> take_arrived() { return std::exchange(arrived_, {}); }

  /// The neighbour is gone, or has restarted.
  void link_lost(const MacAddress& neighbor, Time now);
  /// A search for a route has failed; `nearby`: it looked only there.
  void unreachable(const MacAddress& member, const std::string& reason, bool nearby);

  void poll(Time now);
  Time next_deadline() const;
  bool has_frame(std::uint8_t priority) const;
  /// From whom the frames come that wait; all zero for those of the own group.
  void add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const;
  /// Nothing if none waits that came from there.
  std::optional<GroupFrame> next_frame(std::uint8_t priority, const MacAddress& previous_hop, bool follows, Time now);
  /// Forgets what has been idle.
  void expire(Time now);

  const std::map<MacAddress, Tree>& trees() const { return trees_; }

 private:
  using Streams = std::array<GroupStream, transport::kPriorities>;
  struct Branch {
    Streams streams;
    std::map<MacAddress, int> refusals;
    std::map<MacAddress, Time> activated_again;
    bool build_anew = false;
    bool stale = false;             ///< the tree reaches somebody no more; the next packet gets a new one
    bool fresh = true;              ///< the tree has just been built
    std::set<MacAddress> left_out;  ///< members that the fresh tree did not reach: another one would not, either
    bool busy = true;               ///< something came for it; otherwise nothing is due
    // The rhythm of the frames from upstream.
    std::uint64_t last_counter = 0;
    Time last_arrival{0};
    std::uint64_t measured_counter = 0;
    Time spacing{0};
    transport::RoundTrip round_trip{std::chrono::milliseconds(30), std::chrono::milliseconds(10),
                                    std::chrono::milliseconds(200)};
  };

  // distributor_tree.cpp
  Tree& tree_of(const MacAddress& root, wire::BootTag boot, Time now);
  Tree* find_tree(const MacAddress& root, wire::BootTag boot);
  void forget_tree(const MacAddress& root);
  void build_anew(Time now);
  void renew_stale(Tree& tree);
  void next_epoch(Tree& tree);
  void refused_with_little(const MacAddress& member);
  bool look_for(const MacAddress& root, const MacAddress& member, Time now);
  std::set<MacAddress> attach(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members, Time now);
  void attach_routed(Time now);
  void activate_again(const MacAddress& root, const Tree& tree, const MacAddress& child, Time now);
  void activate(const MacAddress& root, const Tree& tree, const std::set<MacAddress>& children);
  void turn_down(const MacAddress& from, const wire::GroupActivation& activation);
  static std::set<MacAddress> keep_attached(Tree& tree, const std::map<MacAddress, std::set<MacAddress>>& before,
                                            std::set<MacAddress> members);
  static std::set<MacAddress> changed_children(const Tree& tree,
                                               const std::map<MacAddress, std::set<MacAddress>>& before, bool anew);
  static void forget_rhythm(Branch& branch);
  void give_up(const MacAddress& root, Tree& tree, const std::vector<MacAddress>& children, Time now);
  static void leave(Tree& tree);
  void refuse(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members);
  std::set<MacAddress> attach_elsewhere(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members);
  enum class Awaited { kNothing, kLittle, kMuch };
  Awaited awaited(const MacAddress& member) const;
  static bool is_little(const Transfer& transfer);
  void refused_at_root(const std::set<MacAddress>& members, const std::string& reason, bool final);
  void children_changed(const MacAddress& root, bool anew, Time now);
  bool is_root(const MacAddress& root) const { return root == self_.address; }

  // distributor.cpp
  Transfer* transfer_for(const MacAddress& root, Tree& tree, const wire::GroupData& data, Time now);
  void tell_no_room(const Tree& tree, const wire::GroupData& data, GroupStream& stream, Time now);
  void made_progress(const Transfer& transfer, std::size_t octets, Time now);
  void erase_transfer(GroupStream& stream, GroupStream::Transfers::iterator transfer);
  void pass_over(const MacAddress& root, GroupStream& stream, std::uint32_t base);
  void skip_to(const MacAddress& root, GroupStream& stream, std::uint32_t number);
  void deliver(const MacAddress& root, GroupStream& stream);
  bool settled(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number,
               const Transfer& transfer) const;
  void tell_complete(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number,
                     Transfer& transfer);
  void disown(const MacAddress& from, const wire::GroupData& question);
  void report(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number, Transfer& transfer,
              bool reliably);
  void serve(const MacAddress& root, Tree& tree, std::uint8_t stream, std::uint32_t number, Transfer& transfer,
             Time now);
  wire::GroupData header(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number,
                         const Transfer& transfer) const;
  static std::uint32_t oldest_open(const GroupStream& stream);
  void begin(Transfer& transfer, SendId id, transport::Image image, const Tree& tree, Time now);
  void finish_member(Transfer& transfer, const MemberEnd& end);
  void remove_finished();
  std::optional<GroupFrame> next_frame_of(const MacAddress& root, Branch& branch, std::uint8_t priority, bool follows,
                                          Time now);
  static bool idle(const Branch& branch);
  static bool has_frame(const Branch& branch, std::uint8_t priority);
  MacAddress previous_hop(const MacAddress& root) const;

  const Identity& self_;
  routing::Router& router_;
  Outbox& outbox_;
  Random& random_;
  transport::AirClock& air_;
  transport::Reassembly& reassembly_;
  std::size_t largest_packet_;
  std::uint16_t segment_size_;
  std::uint8_t first_parity_;
  std::map<MacAddress, Tree> trees_;
  std::map<MacAddress, Branch> branches_;  ///< of the same roots
  MacAddress last_root_served_{};
  std::vector<MemberEnd> ends_;
  std::vector<Arrived> arrived_;
};

}  // namespace adhoc_communication::multicast
