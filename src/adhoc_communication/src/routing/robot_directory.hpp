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
};

struct DirectoryChange {
  std::string robot;
  MacAddress address{};
  wire::BootTag boot = 0;  ///< the run that appeared or is lost
  bool appeared = false;
};

/// A rumour is news only if it carries a greater life sign than known. Nobody but the robot itself raises that sign, so
/// a lost robot's rumours die out instead of being counted up to infinity. At most kMostRobots; when full, new ones are
/// not taken in until a robot is lost.
class RobotDirectory {
 public:
  static constexpr std::size_t kMostRobots = LivingRuns::kMostRobots;
  static constexpr int kSpreads = 3;  ///< beacons that repeat a life sign, against lost beacons
  static constexpr Time kSilence = std::chrono::seconds(5);

  RobotDirectory(LivingRuns& runs, std::string own_name) : runs_(runs), own_name_(std::move(own_name)) {}

  /// False when another run of the robot lives, or the directory is full.
  bool learn(const MacAddress& address, const std::string& name, wire::BootTag boot, std::uint8_t hops, Time now);
  /// As learn(), with a life sign; takes only news. `teller`: the neighbour that says so, over a good link.
  void life_sign(const MacAddress& address, const std::string& name, wire::BootTag boot, std::uint32_t alive,
                 std::uint8_t hops, std::optional<MacAddress> teller, Time now);
  /// Data of the robot arrived, so it lives.
  void traffic(const MacAddress& address, wire::BootTag boot, Time now);

  const Robot* find(const MacAddress& address) const;
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
  /// Names that two robots have had at the same time for kSilence, be it this one's own. Each once.
  std::vector<std::string> take_taken_names() { return std::exchange(taken_names_, {}); }

 private:
  void heard_again(Robot& robot, std::uint32_t alive, std::uint8_t hops, const std::optional<MacAddress>& teller);
  Robot* admit(const MacAddress& address, const std::string& name, wire::BootTag boot, Time now);
  static Time patience(const Robot& robot) { return kSilence + (robot.hops - 1) * std::chrono::seconds(2); }

  const Robot* namesake(const Robot& robot) const;
  void appear(Robot& robot, const MacAddress& address, Time now);
  void fall_silent(Robot& robot, const MacAddress& address);
  void set_hops(Robot& robot, std::uint8_t hops);
  void forget_name(const Robot& robot, const MacAddress& address);
  void look_for_taken_names();
  bool is_taken(const std::string& name, const std::set<MacAddress>& bearers) const;

  LivingRuns& runs_;
  AddressMap<Robot> robots_;
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
