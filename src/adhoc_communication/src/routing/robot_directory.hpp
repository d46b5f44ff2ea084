// All robots known, near and far: name, address, distance. Says when one appears and when one is lost.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "address_map.hpp"
#include "round_robin.hpp"
#include "routing/living_runs.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::routing {

struct Robot {
  std::string name;
  wire::BootTag boot = 0;  ///< the run that this is said of
  std::uint8_t hops = 1;
  Time last_news{0};
  Time appeared{0};
  bool announced = false;
  int spreads_left = 0;              ///< beacons that still carry the latest life sign
  std::optional<MacAddress> teller;  ///< neighbour that brought the latest life sign over a good link
  std::uint32_t told = 0;            ///< that life sign
  MacAddress brought_by{};           ///< neighbour that told of it first; all zero if it was heard itself since
};

struct DirectoryChange {
  std::string robot;
  MacAddress address{};
  wire::BootTag boot = 0;  ///< the run that appeared or is lost
  bool appeared = false;
};

/// A rumour is news only if it carries a greater life sign than known. Nobody but the robot itself raises that sign, so
/// a lost robot's rumours die out instead of being counted up to infinity.
///
/// At most kMostRobots, of these kMostHeard that are heard themselves, and kMostOfATeller that one neighbour has
/// brought. Where there is no more room, lost ones make it. A robot that is heard itself else takes the place of the
/// one heard longest ago where these are too many, or of one only told of, by the neighbour that has brought most; one
/// that is told of is else not taken in.
class RobotDirectory {
 public:
  static constexpr std::size_t kMostRobots = LivingRuns::kMostRobots;
  static constexpr std::size_t kMostHeard = kMostRobots / 2;
  static constexpr std::size_t kMostOfATeller = kMostRobots / 4;
  static constexpr int kSpreads = 3;  ///< beacons that repeat a life sign, against lost beacons
  static constexpr Time kSilence = std::chrono::seconds(5);

  RobotDirectory(LivingRuns& runs, std::string own_name) : runs_(runs), own_name_(std::move(own_name)) {}

  /// A neighbour, `from`, says so. False when another run of the robot lives, or there is no room for it.
  bool learn(const MacAddress& address, const std::string& name, wire::BootTag boot, std::uint8_t hops,
             const MacAddress& from, Time now);
  /// As learn(), with a life sign; takes only news. `good_link`: that to the neighbour is.
  void life_sign(const MacAddress& address, const std::string& name, wire::BootTag boot, std::uint32_t alive,
                 std::uint8_t hops, const MacAddress& from, bool good_link, Time now);
  /// Data of the robot arrived, so it lives.
  void traffic(const MacAddress& address, wire::BootTag boot, Time now);

  const Robot* find(const MacAddress& address) const;
  /// It has appeared, and is not lost.
  bool present(const MacAddress& address) const;
  /// Something has told since that it lives: itself, its data or others.
  bool has_news_since(const MacAddress& address, Time since) const;
  /// The neighbour that has told of the far robot last: life signs come by it, so it lies on a way there. Life signs
  /// grow along that way, so it has no loops.
  std::optional<MacAddress> teller_of(const MacAddress& address) const;
  std::optional<MacAddress> address_of(const std::string& name) const;
  /// Another number once address_of() may answer otherwise.
  std::uint64_t version() const { return version_; }
  std::vector<std::string> names() const;
  std::size_t size() const { return robots_.size(); }

  /// The next rumours to spread, at most `most`; each call counts as one beacon. `wanted` says whether a robot is worth
  /// a rumour.
  template <typename Predicate>
  std::vector<wire::Rumor> take_rumors(std::size_t most, Predicate wanted);

  void expire(Time now);
  std::vector<DirectoryChange> take_changes();
  /// Names that two robots have had at the same time for kSilence, be it this one's own, and those of robots whose
  /// address another one uses. Each once.
  std::vector<std::string> take_taken_names() { return std::exchange(taken_names_, {}); }

 private:
  using Robots = AddressMap<Robot>;

  void heard_again(Robot& robot, std::uint32_t alive, std::uint8_t hops, const MacAddress& from, bool good_link);
  Robot* admit(const MacAddress& address, const std::string& name, wire::BootTag boot, std::uint8_t hops,
               const MacAddress& from, Time now);
  bool is_full(const MacAddress& bringer) const;
  bool has_room(const MacAddress& address, const MacAddress& from, Time now);
  Robots::iterator in_whose_place(const MacAddress& bringer, Time now);
  template <typename Predicate>
  Robots::iterator least(Predicate candidate, Time now);
  std::size_t brought_by(const MacAddress& bringer) const;
  void set_brought_by(Robot& robot, const MacAddress& bringer);
  void forget_bringer(const Robot& robot);
  Robots::iterator remove(Robots::iterator robot);
  static Time patience(const Robot& robot) { return kSilence + (robot.hops - 1) * std::chrono::seconds(2); }

  const Robot* namesake(const Robot& robot) const;
  void appear(Robot& robot, const MacAddress& address, Time now);
  void fall_silent(Robot& robot, const MacAddress& address);
  void set_hops(Robot& robot, std::uint8_t hops);
  void forget_name(const Robot& robot, const MacAddress& address);
  void look_for_taken_names(const std::set<std::string>& contested);
  bool is_taken(const std::string& name, const std::set<MacAddress>& bearers) const;

  LivingRuns& runs_;
  Robots robots_;
  std::map<MacAddress, std::size_t> brought_;            ///< how many, by who has brought them
  std::map<std::string, std::set<MacAddress>> by_name_;  ///< more than one if a robot has got another radio
  std::vector<DirectoryChange> changes_;
  const std::string own_name_;
  std::set<std::string> reported_names_;
  std::vector<std::string> taken_names_;
  MacAddress last_spread_{};
  std::uint64_t version_ = 0;
};

template <typename Predicate>
std::vector<wire::Rumor> RobotDirectory::take_rumors(std::size_t most, Predicate wanted) {
  std::vector<wire::Rumor> rumors;
  if (most == 0) return rumors;
  visit_after(robots_, last_spread_, [&](auto& item) {
    auto& [address, robot] = item;
    if (robot.spreads_left <= 0 || !robot.announced || robot.hops >= wire::kFarthestHop) return false;
    --robot.spreads_left;
    if (!wanted(address, robot.boot) || !runs_.lives(address, robot.boot)) return false;
    rumors.push_back({address, robot.boot, runs_.life_sign(address), robot.hops, robot.name});
    return rumors.size() == most;
  });
  if (!rumors.empty()) last_spread_ = rumors.back().address;
  return rumors;
}

}  // namespace adhoc_communication::routing
