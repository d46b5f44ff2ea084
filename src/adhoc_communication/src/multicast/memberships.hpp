// The groups of other robots that this robot belongs to, or wants to.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "routing/request_load.hpp"
#include "routing/robot_directory.hpp"

namespace adhoc_communication::multicast {

/// What this robot is to one group.
struct Membership {
  bool joined = false;
  bool joining = false;              ///< a join is on its way to the root
  bool asked_by_host = false;        ///< the end of the change has to be reported
  std::optional<Time> confirmed_by;  ///< a join that the host has asked for: when the root has to have named this robot
  bool leaving = false;              ///< a leave is on its way to the root
  bool left = false;                 ///< the leave has arrived; remembered, so that nobody joins again by himself
  bool turned_away = false;          ///< the root has said so before the join was acknowledged
  bool wanted = true;                ///< false once the host has left
  bool after_leave = false;          ///< the host had left before the join under way: if it fails, that holds again
  Time begun{0};                     ///< the join under way, that happens by itself
  Time retry_at{0};                  ///< when to ask again after a failure
  int failures = 0;                  ///< of joins that nobody has asked for, in a row
};

/// Something that the root of a group is to be told or asked; its end comes back as an argument of said().
struct Word {
  enum class Kind { kJoin, kLeave, kConfirmation };
  Kind kind = Kind::kJoin;
  std::string group;
};

/// Joins and leaves until the root has heard of it; a join that fails is over, but for those that happen by themselves.
/// Whoever calls takes the words for roots and the ends of changes afterwards.
class Memberships {
 public:
  static constexpr std::size_t kMostGroups = 1024;         ///< no further ones are joined
  static constexpr Time kRetry = std::chrono::seconds(2);  ///< doubled with each failure of a join by itself
  static constexpr int kMostDoublings = 4;
  // Joins that happen by themselves. All of a large team at once would leave no air for any.
  static constexpr int kJoinsAtOnce = 4;
  static constexpr Time kJoinSpacing = std::chrono::milliseconds(4);  ///< times the robots known: of the whole team
  static constexpr Time kJoinBurst = std::chrono::milliseconds(100);  ///< by which one may be early
  static constexpr Time kSlowJoin = std::chrono::milliseconds(350);   ///< takes so long that others need the air more
  static constexpr int kMostSlowdowns = 6;                            ///< doublings of the spacing
  static constexpr Time kLongestSpacing = std::chrono::seconds(5);    ///< and the least while searches fill the air
  static constexpr Time kFullRetry = std::chrono::seconds(30);        ///< after the root had no room for this robot
  static constexpr Time kMembersPatience = std::chrono::seconds(5);

  /// `automatic`: every robot's group is joined, except for those that the host has left. `most_members`: a group that
  /// has as many is full.
  Memberships(const routing::RobotDirectory& directory, const routing::RequestLoad& load, bool automatic,
              std::size_t most_members)
      : directory_(directory), load_(load), automatic_(automatic), most_members_(most_members) {}

  // The host wants it, of a group of another robot.
  void join(const std::string& group);
  void leave(const std::string& group);

  // The root.
  void appeared(const std::string& root, Time now);
  void lost(const std::string& root);
  /// Who belongs to its group.
  void named(const std::string& group, bool this_robot, std::size_t members, Time now);
  /// The end of a word to it.
  void said(const Word& word, bool delivered, const std::string& reason, Time now);

  /// What is to be tried again or has waited for too long; to be called a few times a second.
  void expire(Time now);

  std::vector<Word> take_words() { return std::exchange(words_, {}); }
  std::vector<GroupChangeFinished> take_ends() { return std::exchange(ends_, {}); }

  bool joined(const std::string& group) const;
  /// The host has left it: its packets are not wanted.
  bool refuses(const std::string& group) const;
  /// This run has joined, or is about to, or its leave has not arrived.
  bool takes_part(const std::string& group) const;
  const Membership* find(const std::string& group) const;
  /// Those that the root counts this robot to, as far as is known.
  std::vector<std::string> groups() const;
  std::size_t size() const { return memberships_.size(); }

  /// The run ends: so do the changes that the host waits for.
  void end(const std::string& reason);
  /// What the host wanted of a former run.
  void succeed(const Memberships& former);

 private:
  void forget_unknown();
  void start_join(const std::string& group);
  void start_waiting(Time now);
  const std::string* nearest_waiting(Time now) const;
  const routing::Robot* root_in_reach(const std::string& group) const;
  int joins_under_way(Time now) const;
  void start_leave(const std::string& group);
  void end_join(const std::string& group, const std::string& failure, Time now);
  void give_up_join(const std::string& group, const std::string& failure, Time now);
  void turned_away(const std::string& group, std::size_t members, Time now);
  void count_pace(const Membership& membership, bool delivered, Time now);
  void left(const std::string& group, bool delivered);

  const routing::RobotDirectory& directory_;
  const routing::RequestLoad& load_;
  bool automatic_;
  std::size_t most_members_;
  std::map<std::string, Membership> memberships_;
  Time next_join_at_{0};  ///< by itself
  Time latest_join_{0};   ///< by itself
  int slowdowns_ = 0;     ///< for joins that took long or failed, less those that did not
  std::vector<Word> words_;
  std::vector<GroupChangeFinished> ends_;
};

}  // namespace adhoc_communication::multicast
