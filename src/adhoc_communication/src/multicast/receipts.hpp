// What members have of flooded packets, gathered on the way to the roots: each robot waits for those that are farther
// from the root, and tells the neighbour from which the packet came. Where that link works no more, the rest of the way
// is the route to the root: otherwise the next robot might give it back.
#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "multicast/flooding.hpp"
#include "outbox.hpp"
#include "routing/router.hpp"

namespace adhoc_communication::multicast {

/// Of at most kMostKept members of all roots it is known what they have; of others nothing is passed on, and the root
/// sends them what it believes to be missing.
class Receipts {
 public:
  static constexpr std::size_t kMostKept = 8192;
  static constexpr Time kStep = std::chrono::milliseconds(20);    ///< that a robot waits less than one nearer by a hop
  static constexpr int kDeepest = 5;                              ///< hops; who is farther does not wait
  static constexpr Time kSettled = std::chrono::seconds(2);       ///< by then it has arrived, or never will
  static constexpr Time kAgain = std::chrono::milliseconds(100);  ///< that a way is looked for, until then
  static constexpr Time kIdle = std::chrono::seconds(20);

  Receipts(const routing::Neighbors& neighbors, const routing::Router& router, const Flooding& flooding, Outbox& outbox,
           Random& random, std::size_t most_in_a_frame)
      : neighbors_(neighbors),
        router_(router),
        flooding_(flooding),
        outbox_(outbox),
        random_(random),
        most_in_a_frame_(most_in_a_frame) {}

  /// What this robot has of a packet that came over so many hops.
  void owe(const wire::GroupReceipt& own, int hops, Time now);
  /// What another one has.
  void pass_on(const wire::GroupReceipt& receipt, Time now);
  /// What was told to it lately may not have arrived, and goes another way.
  void link_lost(const MacAddress& neighbor, Time now);
  void poll(Time now);
  Time next_deadline() const { return next_; }
  /// Forgets members of which nothing came for long.
  void expire(Time now);

  std::size_t kept() const { return kept_.size(); }

 private:
  using Stream = std::tuple<MacAddress, wire::BootTag, std::uint8_t>;  ///< root, its run, priority
  using Key = std::pair<Stream, MacAddress>;                           ///< and the member
  struct Kept {
    wire::GroupReceipt receipt;
    Time due = Time::max();  ///< nothing is owed
    Time heard{0};
    MacAddress told{};  ///< who was told last
    Time told_at{0};
  };

  static Stream stream_of(const wire::GroupReceipt& receipt) {
    return {receipt.root, receipt.root_boot, receipt.stream};
  }
  void keep(const wire::GroupReceipt& receipt, Time due, Time now);
  struct Way {
    MacAddress neighbor{};
    bool by_route = false;
  };
  std::optional<Way> way_to(const wire::GroupReceipt& receipt, Time now) const;
  void send(const MacAddress& neighbor, const std::vector<wire::GroupReceipt>& receipts);

  const routing::Neighbors& neighbors_;
  const routing::Router& router_;
  const Flooding& flooding_;
  Outbox& outbox_;
  Random& random_;
  std::size_t most_in_a_frame_;
  std::map<Key, Kept> kept_;
  std::map<Stream, Time> own_due_;  ///< what comes from others until then goes along
  Time next_ = Time::max();
};

}  // namespace adhoc_communication::multicast
