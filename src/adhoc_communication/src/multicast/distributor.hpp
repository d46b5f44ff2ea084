// Packets for groups, along the trees of their roots: started at the root, passed on, put together, acknowledged.
//
// Puts together who builds the trees, who starts packets, who takes them and who hands them on; what one of them finds
// is told to the others when it has come to its end.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "air/air_clock.hpp"
#include "multicast/downlink.hpp"
#include "multicast/flooding.hpp"
#include "multicast/receipts.hpp"
#include "multicast/sink.hpp"
#include "multicast/source.hpp"
#include "multicast/tree_builder.hpp"

namespace adhoc_communication::multicast {

class Distributor {
 public:
  static constexpr std::size_t kFewestFlooded = 4;  ///< members

  Distributor(const Identity& self, routing::Router& router, Outbox& outbox, Random& random, air::AirClock& air,
              const Carriage& carriage, const routing::Neighbors& neighbors, transport::Reassembly& reassembly,
              std::size_t largest_packet, std::uint16_t segment_size);

  // At the root.
  /// Whether the next packet gets a new tree.
  bool builds_anew() const;
  /// Whether a packet of so many octets is passed on by everybody rather than along the tree. `far_members`: those of
  /// the `members` that do not hear the root. `robots`: that are known.
  bool floods(std::size_t octets, Priority priority, std::size_t members, std::size_t far_members,
              std::size_t robots) const;
  /// As start(), for a packet of which floods() holds.
  std::uint32_t flood(SendId id, Priority priority, transport::Image image, const std::set<MacAddress>& members,
                      Time now);
  /// Sends to `members` along the tree and returns the number of the packet; one MemberEnd follows for each.
  std::uint32_t start(SendId id, Priority priority, transport::Image image, const std::set<MacAddress>& members,
                      Time now);
  std::optional<std::uint32_t> replace(SendId former, SendId id, const transport::Image& image,
                                       const std::set<MacAddress>& members, Time now);
  std::set<MacAddress> drop(SendId id);
  /// The member has left or is lost.
  void drop_member(const MacAddress& member, const std::string& reason, Time now);
  void copy_started(std::uint8_t stream, std::uint32_t number) { source_.copy_started(stream, number); }
  void copy_finished(std::uint8_t stream, std::uint32_t number) { source_.copy_finished(stream, number); }
  void copy_arrived(const MacAddress& member, std::uint8_t stream, std::uint32_t number, Time now);
  bool has_delivered(const MacAddress& member, std::uint8_t stream, std::uint32_t number) const {
    return source_.has_delivered(member, stream, number);
  }
  void forget_receipts(const MacAddress& member) { source_.forget_receipts(member); }
  std::vector<MemberEnd> take_ends() { return source_.take_ends(); }

  // At every robot.
  void on_activation(const Run& from, const wire::GroupActivation& activation, bool takes_part, Time now);
  void on_refusal(const MacAddress& from, const wire::GroupRefusal& refusal, Time now);
  /// Whether this robot knows its place in the tree of that run.
  bool has_place(const MacAddress& root, wire::BootTag boot) const;
  /// True when the frame was of use. `member`: the root has taken this robot in. Without a place, as its activation is
  /// late or lost, what it hears by then is its own.
  bool on_data(const MacAddress& from, std::uint64_t counter, const wire::GroupData& data, bool member, Time now);
  void on_receipts(const wire::GroupReceipts& receipts, Time now);
  void on_report(const MacAddress& from, const wire::GroupReport& report, Time now);
  void evicted(const transport::Reassembly::Key& key);
  void take_copy(const MacAddress& root, wire::BootTag boot, std::uint8_t stream, std::uint32_t number,
                 const Bytes& image, Time now);
  std::vector<Arrived> take_arrived() { return sink_.take_arrived(); }

  void link_lost(const MacAddress& neighbor, Time now);
  void appeared(const Run& neighbor) { trees_.appeared(neighbor); }
  void unreachable(const MacAddress& member, const std::string& reason, bool nearby, Time now);

  void poll(Time now);
  Time next_deadline() const;
  bool has_frame(std::uint8_t priority) const { return flooding_.has_frame(priority) || downlink_.has_frame(priority); }
  void add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const {
    flooding_.add_waiting_hops(priority, hops);
    downlink_.add_waiting_hops(priority, hops);
  }
  /// Nothing if none waits that came from there. `follows`: where the frame went to which this one may follow without a
  /// gap.
  std::optional<GroupFrame> next_frame(std::uint8_t priority, const MacAddress& previous_hop,
                                       const std::optional<MacAddress>& follows, Time now);
  /// Forgets what has been idle.
  void expire(Time now);

  const AddressMap<Branch>& branches() const { return branches_.all(); }
  const Flooding& flooding() const { return flooding_; }
  const Receipts& receipts() const { return receipts_; }

 private:
  void settle(Time now);
  void serve(const MacAddress& root, Branch& branch, Time now);
  std::uint32_t base_of(const Place& place) const;
  bool on_flooded(const MacAddress& from, const wire::GroupData& data, bool member, Time now);
  void pass_on_copy(const MacAddress& root, const Branch& branch, std::uint8_t stream, std::uint32_t number,
                    const Bytes& image, Time now);
  void owe_receipt(const MacAddress& root, const Branch& branch, std::uint8_t stream, Time now);

  const Identity& self_;
  air::AirClock& air_;
  const Carriage& carriage_;
  std::uint16_t segment_size_;
  Branches branches_;
  TreeBuilder trees_;
  Source source_;
  Sink sink_;
  Downlink downlink_;
  Flooding flooding_;
  Receipts receipts_;
};

}  // namespace adhoc_communication::multicast
