// Packets from upstream: put together, delivered in their order, reported.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "multicast/branches.hpp"
#include "outbox.hpp"
#include "random.hpp"
#include "routing/router.hpp"

namespace adhoc_communication::multicast {

/// A packet that has arrived here, be it to be passed on only: a member may get its packets as a relay of others.
struct Arrived {
  MacAddress root{};
  Bytes image;
  std::uint8_t hops = 1;
};

/// A packet on a branch.
struct Place {
  MacAddress root{};
  Branch& branch;
  std::uint8_t stream = 0;
  std::uint32_t number = 0;
  Transfer& transfer;
};

class Sink {
 public:
  static constexpr std::size_t kMostTransfers = 256;       ///< of one root and priority; those done with make room
  static constexpr std::size_t kMostDone = 256;            ///< that have made room and are remembered
  static constexpr std::uint32_t kPacketsAhead = 1 << 20;  ///< taken beyond what the root has finished
  static constexpr Time kIdleTransfer = std::chrono::seconds(20);
  static constexpr Time kReportJitter = std::chrono::milliseconds(1);
  static constexpr Time kNoRoomInterval = std::chrono::milliseconds(50);  ///< between two words about it

  Sink(const Identity& self, routing::Router& router, Outbox& outbox, Random& random, transport::Reassembly& reassembly,
       std::size_t largest_packet, std::uint8_t first_parity)
      : self_(self),
        router_(router),
        outbox_(outbox),
        random_(random),
        reassembly_(reassembly),
        largest_packet_(largest_packet),
        first_parity_(first_parity) {}

  /// `branch`: that of the root, if this robot is part of its tree, or a member that will be. True when the frame was
  /// of use.
  bool on_data(const MacAddress& from, std::uint64_t counter, const wire::GroupData& data, Branch* branch, Time now);
  /// A packet that everybody passes on, at a member. True when it was of use.
  bool on_flooded(const wire::GroupData& data, Branch& branch, Time now);
  /// A packet that came to this member by itself.
  void take_copy(const MacAddress& root, Branch& branch, std::uint8_t stream, std::uint32_t number, const Bytes& image,
                 Time now);
  /// Once this robot and all behind it have the packet, upstream hears of it reliably.
  void tell_complete(const Place& place, Time now);
  void report_if_due(const Place& place, Time now);
  /// A frame of it goes to children.
  static void passed_on(const Transfer& transfer, Time now);
  /// The packet had to make room.
  void evicted(Branch& branch, const transport::Reassembly::Key& key);
  /// Forgets packets without news.
  static void expire(Branch& branch, Time now);

  std::vector<Arrived> take_arrived() { return std::exchange(arrived_, {}); }

 private:
  static void measure(Branch& branch, std::uint64_t counter, bool follows, Time now);
  Transfer* transfer_for(Branch& branch, const wire::GroupData& data, Time now);
  void begin(const MacAddress& root, GroupStream& stream, std::uint32_t base);
  Transfer* admit(Branch& branch, const wire::GroupData& data, Time now);
  bool has_place(const MacAddress& root, Branch& branch, std::uint8_t stream);
  static void forget(const Place& place);
  bool is_done_with(Branch& branch, const wire::GroupData& data) const;
  wire::GroupReport report_on(const Tree& tree, const wire::GroupData& data) const;
  void tell_no_room(const Tree& tree, const wire::GroupData& data, GroupStream& stream, Time now);
  void tell_done(const Tree& tree, const wire::GroupData& data);
  static void made_progress(const Transfer& transfer, std::size_t octets, Time now);
  void pass_over(const MacAddress& root, GroupStream& stream, std::uint32_t base);
  void skip_to(const MacAddress& root, GroupStream& stream, std::uint32_t number);
  void deliver(const MacAddress& root, GroupStream& stream);
  static bool settled(const Place& place);
  void disown(const MacAddress& from, const wire::GroupData& question);
  void report(const Place& place, bool reliably, Time now);

  const Identity& self_;
  routing::Router& router_;
  Outbox& outbox_;
  Random& random_;
  transport::Reassembly& reassembly_;
  std::size_t largest_packet_;
  std::uint8_t first_parity_;
  std::vector<Arrived> arrived_;
};

}  // namespace adhoc_communication::multicast
