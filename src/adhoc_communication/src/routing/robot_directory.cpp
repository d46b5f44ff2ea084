#include "routing/robot_directory.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "routing/sequence_number.hpp"

namespace adhoc_communication::routing {
namespace {

constexpr Time kForget = std::chrono::seconds(60);  ///< how long a lost robot is remembered

}  // namespace

bool RobotDirectory::learn(const MacAddress& address, const std::string& name, wire::BootTag boot, std::uint8_t hops,
                           const MacAddress& from, Time now) {
  return admit(address, name, boot, hops, from, now) != nullptr;
}

void RobotDirectory::life_sign(const MacAddress& address, const std::string& name, wire::BootTag boot,
                               std::uint32_t alive, std::uint8_t hops, const MacAddress& from, bool good_link,
                               Time now) {
  const std::uint32_t before = runs_.life_sign(address, boot);
  const bool itself = hops == 1;
  if (!itself) alive = runs_.credible(address, boot, alive, now);
  if (!itself && before != 0 && !is_newer(alive, before)) {
    const auto known = robots_.find(address);
    // A nearer witness of the same life sign shortens the distance; it is no news of life.
    if (known != robots_.end() && known->second.boot == boot) {
      if (alive == before) heard_again(known->second, alive, hops, from, good_link);
      if (alive == before || !runs_.goes_on_below(address, boot, alive, now)) return;
    }
  }
  if (!has_room(address, from, now)) return;
  const bool lives = itself ? runs_.said_alive(address, boot, alive, now) : runs_.told_alive(address, boot, alive, now);
  if (!lives) return;
  Robot* robot = admit(address, name, boot, hops, from, now);
  if (robot == nullptr) return;
  if (runs_.life_sign(address) != before) robot->spreads_left = kSpreads;
  if (good_link) robot->teller = from, robot->told = alive;
}

void RobotDirectory::traffic(const MacAddress& address, wire::BootTag boot, Time now) {
  const auto found = robots_.find(address);
  if (found != robots_.end() && found->second.boot == boot && found->second.announced) found->second.last_news = now;
}

void RobotDirectory::heard_again(Robot& robot, std::uint32_t alive, std::uint8_t hops, const MacAddress& from,
                                 bool good_link) {
  if (good_link && robot.told != alive) robot.teller = from, robot.told = alive;
  if (hops < robot.hops) set_hops(robot, hops);
}

const Robot* RobotDirectory::find(const MacAddress& address) const {
  const auto found = robots_.find(address);
  return found == robots_.end() ? nullptr : &found->second;
}

bool RobotDirectory::present(const MacAddress& address) const {
  const Robot* robot = find(address);
  return robot != nullptr && robot->announced;
}

bool RobotDirectory::has_news_since(const MacAddress& address, Time since) const {
  const Robot* robot = find(address);
  return robot != nullptr && robot->last_news > since;
}

std::optional<MacAddress> RobotDirectory::teller_of(const MacAddress& address) const {
  const Robot* robot = find(address);
  return robot != nullptr && robot->announced && robot->hops > 1 ? robot->teller : std::nullopt;
}

/// Of several the one that lives, and of those the nearest.
std::optional<MacAddress> RobotDirectory::address_of(const std::string& name) const {
  const auto bearers = by_name_.find(name);
  if (bearers == by_name_.end()) return std::nullopt;
  const auto rank = [this](const MacAddress& address) {
    const Robot& robot = robots_.at(address);
    return std::pair(robot.announced ? 0 : 1, robot.hops);
  };
  return *std::min_element(bearers->second.begin(), bearers->second.end(),
                           [&](const MacAddress& a, const MacAddress& b) { return rank(a) < rank(b); });
}

std::vector<std::string> RobotDirectory::names() const {
  std::vector<std::string> names;
  for (const auto& [name, bearers] : by_name_) {
    const auto present = [this](const MacAddress& address) { return robots_.at(address).announced; };
    if (std::any_of(bearers.begin(), bearers.end(), present)) names.push_back(name);
  }
  return names;
}

void RobotDirectory::expire(Time now) {
  std::set<std::string> contested;
  const bool any_contested = runs_.any_contested(now);
  for (auto iterator = robots_.begin(); iterator != robots_.end();) {
    Robot& robot = iterator->second;
    if (robot.announced && now - robot.last_news >= patience(robot)) fall_silent(robot, iterator->first);
    if (!robot.announced && now - robot.last_news >= kForget) {
      iterator = remove(iterator);
      continue;
    }
    if (any_contested && robot.announced && runs_.contested(iterator->first, now)) contested.insert(robot.name);
    ++iterator;
  }
  look_for_taken_names(contested);
}

/// `contested`: names of robots whose address another one uses.
void RobotDirectory::look_for_taken_names(const std::set<std::string>& contested) {
  const bool names_are_shared = by_name_.size() < robots_.size() || by_name_.count(own_name_) != 0;
  if (!names_are_shared && reported_names_.empty() && contested.empty()) return;
  const auto taken = [&](const std::string& name, const std::set<MacAddress>& bearers) {
    return contested.count(name) != 0 || ((bearers.size() > 1 || name == own_name_) && is_taken(name, bearers));
  };
  for (auto name = reported_names_.begin(); name != reported_names_.end();) {
    const auto bearers = by_name_.find(*name);
    const bool still = bearers != by_name_.end() && taken(*name, bearers->second);
    name = still ? std::next(name) : reported_names_.erase(name);
  }
  for (const auto& [name, bearers] : by_name_) {
    if (!taken(name, bearers)) continue;
    if (reported_names_.insert(name).second) taken_names_.push_back(name);
  }
}

/// Of a robot that has got another radio, the former address falls silent.
bool RobotDirectory::is_taken(const std::string& name, const std::set<MacAddress>& bearers) const {
  std::vector<const Robot*> present;
  Time latest{0};
  for (const MacAddress& address : bearers) {
    const Robot& robot = robots_.at(address);
    if (!robot.announced) continue;
    present.push_back(&robot);
    latest = std::max(latest, robot.appeared);
  }
  const auto lasting = std::count_if(present.begin(), present.end(),
                                     [&](const Robot* robot) { return robot->last_news - latest >= kSilence; });
  return lasting + (name == own_name_ ? 1 : 0) >= 2;
}

/// Which of several bearers of a name is the nearest may change by it; mostly there are none.
void RobotDirectory::set_hops(Robot& robot, std::uint8_t hops) {
  const bool names_are_shared = by_name_.size() < robots_.size();
  if (std::exchange(robot.hops, hops) != hops && names_are_shared && by_name_.at(robot.name).size() > 1) ++version_;
}

void RobotDirectory::forget_name(const Robot& robot, const MacAddress& address) {
  const auto bearers = by_name_.find(robot.name);
  ++version_;
  bearers->second.erase(address);
  if (bearers->second.empty()) by_name_.erase(bearers);
}

/// The announced bearer of the robot's name other than itself; null if there is none.
const Robot* RobotDirectory::namesake(const Robot& robot) const {
  for (const MacAddress& address : by_name_.at(robot.name)) {
    const Robot& other = robots_.at(address);
    if (&other != &robot && other.announced) return &other;
  }
  return nullptr;
}

/// What a robot of that name was before, over another radio, is over now.
void RobotDirectory::appear(Robot& robot, const MacAddress& address, Time now) {
  if (const Robot* former = namesake(robot)) changes_.push_back({robot.name, address, former->boot, false});
  ++version_;
  robot.announced = true;
  robot.appeared = now;
  robot.spreads_left = kSpreads;
  changes_.push_back({robot.name, address, robot.boot, true});
}

/// A robot that has got another radio is not lost when its former address is.
void RobotDirectory::fall_silent(Robot& robot, const MacAddress& address) {
  ++version_;
  robot.announced = false;
  if (namesake(robot) == nullptr) changes_.push_back({robot.name, address, robot.boot, false});
}

std::vector<DirectoryChange> RobotDirectory::take_changes() { return std::exchange(changes_, {}); }

Robot* RobotDirectory::admit(const MacAddress& address, const std::string& name, wire::BootTag boot, std::uint8_t hops,
                             const MacAddress& from, Time now) {
  if (!runs_.lives(address, boot) || !has_room(address, from, now)) return nullptr;
  const MacAddress bringer = address == from ? MacAddress{} : from;
  auto found = robots_.find(address);
  if (found == robots_.end()) {
    if (is_full(bringer)) remove(in_whose_place(bringer, now));
    found = robots_.emplace(address, Robot{}).first;
    found->second.boot = boot;
    found->second.name = name;
    by_name_[name].insert(address);
    ++brought_[bringer];
    found->second.brought_by = bringer;
  }
  Robot& robot = found->second;
  if (robot.boot != boot || robot.name != name) {
    if (robot.announced) fall_silent(robot, address);
    forget_name(robot, address);
    by_name_[name].insert(address);
    robot.boot = boot;
    robot.name = name;
    robot.teller.reset();
    robot.told = 0;
  }
  robot.last_news = now;
  if (!robot.announced) appear(robot, address, now);
  set_hops(robot, hops);
  const bool drove_away = robot.brought_by == MacAddress{} && !runs_.heard_lately(address, now);
  if (bringer == MacAddress{} || drove_away) set_brought_by(robot, bringer);
  return &robot;
}

bool RobotDirectory::is_full(const MacAddress& bringer) const {
  const std::size_t most = bringer == MacAddress{} ? kMostHeard : kMostOfATeller;
  return robots_.size() >= kMostRobots || brought_by(bringer) >= most;
}

bool RobotDirectory::has_room(const MacAddress& address, const MacAddress& from, Time now) {
  const MacAddress bringer = address == from ? MacAddress{} : from;
  return robots_.count(address) != 0 || !is_full(bringer) || in_whose_place(bringer, now) != robots_.end();
}

/// When it is full for that bringer; the end if nobody gives way.
RobotDirectory::Robots::iterator RobotDirectory::in_whose_place(const MacAddress& bringer, Time now) {
  const bool itself = bringer == MacAddress{};
  const auto is_of = [](const MacAddress& whose) {
    return [whose](const Robot& robot) { return robot.brought_by == whose; };
  };
  if (brought_by(bringer) >= (itself ? kMostHeard : kMostOfATeller)) {
    const auto own = least(is_of(bringer), now);
    return itself || !own->second.announced ? own : robots_.end();
  }
  const auto lost = least([](const Robot& robot) { return !robot.announced; }, now);
  if (lost != robots_.end() || !itself) return lost;
  const auto greediest = std::max_element(brought_.begin(), brought_.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first != MacAddress{}, a.second) < std::pair(b.first != MacAddress{}, b.second);
  });
  return least(is_of(greediest->first), now);
}

/// A lost one, else one that was not heard itself lately, the farthest of these, else the one without news for longest.
template <typename Predicate>
RobotDirectory::Robots::iterator RobotDirectory::least(Predicate candidate, Time now) {
  const auto worth = [&](Robots::iterator robot) {
    const auto& [address, state] = *robot;
    return std::tuple(state.announced, runs_.heard_lately(address, now), -state.hops, state.last_news);
  };
  auto least = robots_.end();
  for (auto robot = robots_.begin(); robot != robots_.end(); ++robot) {
    if (candidate(robot->second) && (least == robots_.end() || worth(robot) < worth(least))) least = robot;
  }
  return least;
}

std::size_t RobotDirectory::brought_by(const MacAddress& bringer) const {
  const auto found = brought_.find(bringer);
  return found == brought_.end() ? 0 : found->second;
}

void RobotDirectory::set_brought_by(Robot& robot, const MacAddress& bringer) {
  if (robot.brought_by == bringer) return;
  forget_bringer(robot);
  ++brought_[bringer];
  robot.brought_by = bringer;
}

void RobotDirectory::forget_bringer(const Robot& robot) {
  const auto bringer = brought_.find(robot.brought_by);
  if (--bringer->second == 0) brought_.erase(bringer);
}

/// Returns the robot behind it.
RobotDirectory::Robots::iterator RobotDirectory::remove(Robots::iterator robot) {
  auto& [address, state] = *robot;
  if (state.announced) fall_silent(state, address);
  forget_name(state, address);
  forget_bringer(state);
  return robots_.erase(robot);
}

}  // namespace adhoc_communication::routing
