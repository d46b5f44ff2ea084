// Who is heard on the radio, and who of them hears this robot.
#pragma once

#include <boost/container/flat_map.hpp>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "address_map.hpp"
#include "adhoc_communication/timings.hpp"
#include "routing/link_cost.hpp"
#include "routing/link_layer.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::routing {

struct Neighbor {
  static constexpr double kUnknownLoss = 0.5;  ///< of frames of which nothing is known

  wire::BootTag boot = 0;
  Time last_heard{0};
  Time interval{0};            ///< of its beacons (RFC 3561 section 9.1)
  int beacons_per_list = 1;    ///< so many of its beacons name all that it hears
  std::optional<Time> listed;  ///< when it last showed that it hears this robot
  bool failed = false;         ///< the link worked and failed; nothing was heard since
  Time blacklisted_until{0};   ///< section 6.8: it did not acknowledge a reply
  struct Hears {
    Time said{0};
    double loss = 0.0;  ///< of the beacons it hears, 0..1
  };
  boost::container::flat_map<wire::NeighborTag, Hears> hears;
  double reported_loss = kUnknownLoss;  ///< of frames to it, as its beacons say, 0..1
  std::optional<double> seen_loss;      ///< of frames to it, as the hop ARQ sees it
  double loss_from = kUnknownLoss;      ///< of its beacons
  std::uint16_t last_beacon = 0;
  int beacons = 0;  ///< counted for loss_from, no more than matter
  Time named{-1};   ///< when a beacon of this robot named it
};

/// At most kMostNeighbors. A newcomer takes the place of the one heard longest ago of those that have not said that
/// they hear this robot; while all have, it has to wait until one falls silent.
class Neighbors {
 public:
  static constexpr std::size_t kMostNeighbors = 250;

  Neighbors(const Timings& timings, Time own_interval) : timings_(timings), own_interval_(own_interval) {}

  static constexpr double kBadLoss = 0.5;  ///< of a link over which others may do better
  static constexpr int kLongestList = 11;  ///< beacons that name kMostNeighbors
  static constexpr Time kCandidateMemory = std::chrono::seconds(60);

  /// A robot heard that has not proved yet that it is alive now: it is only named in beacons. False when it was known
  /// already.
  bool candidate(const MacAddress& address, wire::BootTag boot, Time now);
  /// Any frame. Null when there is no room.
  Neighbor* heard(const MacAddress& address, wire::BootTag boot, Time now);
  void beacon(const MacAddress& address, const wire::Beacon& beacon, wire::NeighborTag self, Time now);
  /// It acknowledged a frame, so it hears this robot.
  void acknowledged(const MacAddress& address, Time now);
  /// It sent a frame to this robot alone, so it still hears it. By itself that makes no link known to work both ways:
  /// what one loses is not known then.
  void addressed(const MacAddress& address, Time now);
  /// The link failed: frames over it go unanswered until the neighbour says anew that it hears this robot.
  void link_failed(const MacAddress& address);
  /// Section 6.8: the link may work one way only. Until it acknowledges something, what it says does not count.
  void blacklist(const MacAddress& address, Time now);

  const Neighbor* find(const MacAddress& address) const;
  /// Section 6.8: only links that work both ways carry routes.
  bool two_way(const MacAddress& address, Time now) const;
  /// The link worked, failed or fell silent, and nothing was heard since.
  bool is_lost(const Neighbor& neighbor, Time now) const;
  std::vector<MacAddress> all_two_way(Time now) const;
  /// Of a frame to the neighbour that is acknowledged; to one that is not known, that of a perfect hop.
  Cost cost(const MacAddress& address) const;
  /// ALLOWED_HELLO_LOSS * HELLO_INTERVAL of the neighbour.
  Time patience(const MacAddress& address) const;

  /// Those to name in a beacon, at most `most`: newcomers first, then those named longest ago.
  std::vector<wire::HeardNeighbor> next_heard(std::size_t most, Time now);
  /// How many there are to name.
  std::size_t heard_count(Time now) const;
  /// The share of the beacons of that robot that the neighbour gets, 0..1; 0 if it has not named it lately.
  double delivery(const Neighbor& neighbor, wire::NeighborTag robot, Time now) const;
  /// Every neighbour whose link works both ways hears the robot itself, or is it.
  bool all_hear(const MacAddress& robot, wire::BootTag boot, Time now) const;
  /// What `from` sends may reach one of the other neighbours over a robot other than `self`, or at once.
  bool bypassed(const MacAddress& from, wire::NeighborTag self, Time now) const;
  /// Third robots, of `all` whose links work both ways, that hear this one and are heard by that neighbour, half of the
  /// time and more. It has to be known.
  std::size_t ways_round(const MacAddress& address, const std::vector<MacAddress>& all, Time now) const;
  /// What is for that neighbour has to come from this robot: over a good link, or no third robot can bring it.
  bool depends(const MacAddress& address, const std::vector<MacAddress>& all, Time now) const;
  /// It owes a sign of life for some of its beacons; or it is not known.
  bool silent(const MacAddress& address, Time now) const;
  /// Those that are silent, or have not named this robot for as long, and may only be out of luck; not those that will
  /// be given up soon, since their beacons come often.
  std::vector<MacAddress> doubtful(Time now) const;
  /// Removes and returns those silent for longer than `timeout`, and than they may be.
  std::vector<MacAddress> remove_silent(Time timeout, Time now);
  /// Those whose silence has just ended their routes (section 6.9).
  std::vector<MacAddress> newly_silent(Time now);

  const AddressMap<Neighbor>& all() const { return neighbors_; }
  std::size_t candidates() const { return candidates_.size(); }
  /// As the hop ARQ sees it; nothing if it has not seen enough lately.
  void set_loss(const MacAddress& address, std::optional<double> loss);
  /// By which links are compared: that which the hop ARQ sees, or its beacons say where it has seen too little. Where
  /// the link layer hides what frames to one robot lose, that of beacons for all.
  double loss(const MacAddress& address) const;
  /// Frames to one robot by itself, as Wi-Fi does: nothing says that it does not.
  bool radio_may_repeat() const { return link_layer_.repeats() != false; }
  /// Of frames that nobody repeats, as its beacons say.
  double beacon_loss(const MacAddress& address) const;

 private:
  static void count_beacon(Neighbor& neighbor, std::uint16_t number);
  Time patience(const Neighbor& neighbor) const;
  static Time doubt(const Neighbor& neighbor);
  static bool silent(const Neighbor& neighbor, Time now) { return now - neighbor.last_heard > doubt(neighbor); }
  bool two_way(const Neighbor& neighbor, Time now) const;
  bool fell_silent(const Neighbor& neighbor, Time now) const;
  const Neighbor::Hears* hears(const Neighbor& neighbor, wire::NeighborTag robot, Time now) const;

  const Timings& timings_;
  Time own_interval_;
  LinkLayer link_layer_;
  AddressMap<Neighbor> neighbors_;
  /// A recorded run never proves anything, so each is named ever more rarely, and newcomers come first. The one named
  /// most often makes room.
  struct Candidate {
    wire::BootTag boot = 0;
    Time heard{0};
    Time named{0};
    int times = 0;  ///< named
  };
  using Candidates = std::map<std::pair<MacAddress, wire::BootTag>, Candidate>;

  void make_room();
  bool waits(const Candidate& candidate, Time now) const;
  std::vector<wire::HeardNeighbor> next_candidates(std::size_t most, Time now);

  Candidates candidates_;
};

}  // namespace adhoc_communication::routing
