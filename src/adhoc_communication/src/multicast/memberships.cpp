#include "multicast/memberships.hpp"

#include <algorithm>

#include "multicast/groups.hpp"
#include "texts.hpp"

namespace adhoc_communication::multicast {

void Memberships::join(const std::string& group) {
  if (memberships_.count(group) == 0 && memberships_.size() >= kMostGroups) {
    return ends_.push_back(
        {group, true, false,
         "already a member of " + std::to_string(memberships_.size()) + " groups, no more are kept"});
  }
  Membership& membership = memberships_[group];
  membership.after_leave = membership.after_leave || !membership.wanted;
  membership.wanted = true;
  membership.left = false;
  if (membership.joined) return ends_.push_back({group, true, true, {}});
  membership.asked_by_host = true;
  start_join(group);
}

void Memberships::leave(const std::string& group) {
  const auto found = memberships_.find(group);
  if (found == memberships_.end() || !found->second.wanted) {
    return ends_.push_back({group, false, false, "this robot is not a member of " + group});
  }
  if (found->second.asked_by_host) ends_.push_back({group, true, false, group + " was left before it was joined"});
  // Left at once for this robot; the root hears of it as soon as it can be reached.
  found->second = Membership{};
  found->second.wanted = false;
  start_leave(group);
  ends_.push_back({group, false, true, {}});
}

void Memberships::start_join(const std::string& group) {
  if (memberships_.count(group) == 0 && memberships_.size() >= kMostGroups) return;
  Membership& membership = memberships_[group];
  if (!membership.wanted || membership.joining || membership.joined) return;
  membership.joining = true;
  words_.push_back({Word::Kind::kJoin, group});
}

/// Those by themselves; one that takes long counts more than once, and does not hold up the others as long as it is the
/// only one.
int Memberships::joins_under_way(Time now) const {
  int count = 0;
  for (const auto& [group, membership] : memberships_) {
    if (!membership.joining || membership.asked_by_host) continue;
    count += now - membership.begun > kSlowJoin ? kJoinsAtOnce - 1 : 1;
  }
  return count;
}

/// Null while it is not there.
const routing::Robot* Memberships::root_in_reach(const std::string& group) const {
  const auto address = directory_.address_of(*root_of(group));
  const routing::Robot* root = address ? directory_.find(*address) : nullptr;
  return root != nullptr && root->announced ? root : nullptr;
}

/// Of the groups to be joined that whose root is nearest: what is found out on the way to it helps to find the others.
/// But a root that does not answer, however near, waits behind those that have not failed as often.
const std::string* Memberships::nearest_waiting(Time now) const {
  const std::string* nearest = nullptr;
  std::pair<int, int> least;
  for (const auto& [group, membership] : memberships_) {
    if (!membership.wanted || membership.joined || membership.joining || membership.retry_at > now) continue;
    const routing::Robot* root = root_in_reach(group);
    const std::pair<int, int> order(membership.failures, root == nullptr ? 0 : root->hops);
    if (root == nullptr || (nearest != nullptr && order >= least)) continue;
    nearest = &group;
    least = order;
  }
  return nearest;
}

void Memberships::start_waiting(Time now) {
  for (int under_way = joins_under_way(now); under_way < kJoinsAtOnce; ++under_way) {
    if (now + kJoinBurst < next_join_at_ || (load_.full(now) && now < latest_join_ + kLongestSpacing)) return;
    const std::string* nearest = nearest_waiting(now);
    if (nearest == nullptr) return;
    const Time spacing = kJoinSpacing * directory_.size();
    next_join_at_ = std::max(now, next_join_at_) + std::clamp(spacing * (1 << slowdowns_), spacing, kLongestSpacing);
    latest_join_ = memberships_.at(*nearest).begun = now;
    start_join(*nearest);
  }
}

void Memberships::start_leave(const std::string& group) {
  memberships_[group].leaving = true;
  words_.push_back({Word::Kind::kLeave, group});
}

void Memberships::appeared(const std::string& root, Time now) {
  const std::string group = group_of(root);
  if (automatic_ && memberships_.size() < kMostGroups) memberships_[group];
  if (const auto membership = memberships_.find(group); membership != memberships_.end()) {
    membership->second.failures = 0;
    membership->second.retry_at = now;
  }
  start_waiting(now);
}

void Memberships::lost(const std::string& root) {
  const auto membership = memberships_.find(group_of(root));
  if (membership != memberships_.end()) membership->second.joined = false;
}

/// Those that came about by themselves, and would again: of robots that nobody knows any more.
void Memberships::forget_unknown() {
  for (auto entry = memberships_.begin(); automatic_ && entry != memberships_.end();) {
    const Membership& membership = entry->second;
    const bool idle = membership.wanted && !membership.joined && !membership.joining && !membership.asked_by_host;
    const bool unknown = idle && !directory_.address_of(*root_of(entry->first));
    entry = unknown ? memberships_.erase(entry) : std::next(entry);
  }
}

/// By itself, when the root is there.
void Memberships::expire(Time now) {
  forget_unknown();
  std::vector<std::string> unconfirmed;
  for (auto& [group, membership] : memberships_) {
    if (membership.confirmed_by && *membership.confirmed_by <= now) unconfirmed.push_back(group);
    const bool to_leave = !membership.wanted && !membership.leaving && !membership.left;
    if (to_leave && membership.retry_at <= now && root_in_reach(group) != nullptr) start_leave(group);
  }
  start_waiting(now);
  for (const std::string& group : unconfirmed) {
    give_up_join(group, "the root did not answer within " + seconds_text(kMembersPatience), now);
  }
}

void Memberships::said(const Word& word, bool delivered, const std::string& reason, Time now) {
  if (word.kind == Word::Kind::kConfirmation) {
    if (!delivered) give_up_join(word.group, reason, now);
    return;
  }
  const auto found = memberships_.find(word.group);
  if (found == memberships_.end()) return;
  Membership& membership = found->second;
  membership.retry_at = now + kRetry;
  if (word.kind == Word::Kind::kLeave) return left(word.group, delivered);
  membership.joining = false;
  membership.joined = delivered && membership.wanted && !membership.turned_away;
  if (std::exchange(membership.turned_away, false)) membership.retry_at = now + kFullRetry;
  if (!membership.asked_by_host) {
    membership.failures = delivered ? 0 : membership.failures + 1;
    count_pace(membership, delivered, now);
    if (!delivered) {
      const Time pause = kRetry * (1 << std::min(membership.failures - 1, kMostDoublings));
      membership.retry_at = std::max(membership.retry_at, now + pause);
    }
    return start_waiting(now);
  }
  if (!delivered) return give_up_join(word.group, reason, now);
  membership.confirmed_by = now + kMembersPatience;
  words_.push_back({Word::Kind::kConfirmation, word.group});
}

/// A root that fails again and again says something of itself, not of the air.
void Memberships::count_pace(const Membership& membership, bool delivered, Time now) {
  if (membership.failures > 1) return;
  const bool slow = !delivered || now - membership.begun > kSlowJoin;
  slowdowns_ = std::clamp(slowdowns_ + (slow ? 1 : -1), 0, kMostSlowdowns);
}

void Memberships::left(const std::string& group, bool delivered) {
  Membership& membership = memberships_.at(group);
  membership.leaving = false;
  membership.left = delivered && !membership.wanted;
  if (membership.left && !automatic_) memberships_.erase(group);
}

/// A join that the host has asked for has come to its end.
void Memberships::end_join(const std::string& group, const std::string& failure, Time now) {
  const auto found = memberships_.find(group);
  if (found == memberships_.end() || !found->second.asked_by_host) return;
  found->second.asked_by_host = false;
  found->second.confirmed_by.reset();
  const bool after_leave = std::exchange(found->second.after_leave, false);
  if (failure.empty()) return ends_.push_back({group, true, true, {}});
  const bool known = directory_.address_of(*root_of(group)).has_value();
  found->second.joined = false;
  found->second.retry_at = std::max(found->second.retry_at, now + kRetry);
  if (automatic_ && after_leave) {
    found->second.wanted = false;
  } else if (!automatic_ || !known) {
    memberships_.erase(found);
  }
  ends_.push_back({group, true, false, "cannot join " + group + ": " + failure});
}

/// The root may have heard of it all the same, so it is told that this robot is none of its members.
void Memberships::give_up_join(const std::string& group, const std::string& failure, Time now) {
  const Membership* membership = find(group);
  if (membership == nullptr || !membership->asked_by_host) return;
  const bool automatic_again = automatic_ && !membership->after_leave;
  end_join(group, failure, now);
  if (automatic_again || !directory_.address_of(*root_of(group))) return;
  memberships_[group].wanted = false;
  start_leave(group);
}

void Memberships::named(const std::string& group, bool this_robot, std::size_t members, Time now) {
  if (this_robot) return end_join(group, {}, now);
  turned_away(group, members, now);
}

/// The root does not count this robot among its members.
void Memberships::turned_away(const std::string& group, std::size_t members, Time now) {
  const auto found = memberships_.find(group);
  if (found == memberships_.end() || !found->second.wanted) return;
  found->second.turned_away = found->second.joining;
  if (found->second.joining) return;
  const bool full = members >= most_members_;
  found->second.joined = false;
  found->second.retry_at = now + (full ? kFullRetry : Time(0));
  end_join(group,
           full ? "it is full (" + std::to_string(members) + " members)" : "its root does not take this robot in", now);
}

const Membership* Memberships::find(const std::string& group) const {
  const auto found = memberships_.find(group);
  return found == memberships_.end() ? nullptr : &found->second;
}

bool Memberships::joined(const std::string& group) const {
  const Membership* membership = find(group);
  return membership != nullptr && membership->joined;
}

bool Memberships::refuses(const std::string& group) const {
  const Membership* membership = find(group);
  return membership != nullptr && !membership->wanted;
}

bool Memberships::takes_part(const std::string& group) const {
  const Membership* membership = find(group);
  return membership != nullptr && !membership->left;
}

std::vector<std::string> Memberships::groups() const {
  std::vector<std::string> result;
  for (const auto& [group, membership] : memberships_) {
    if (membership.joined || membership.joining) result.push_back(group);
  }
  return result;
}

void Memberships::end(const std::string& reason) {
  for (auto& [group, membership] : memberships_) {
    if (!std::exchange(membership.asked_by_host, false)) continue;
    membership.joined = false;
    membership.wanted = automatic_ && !membership.after_leave;
    ends_.push_back({group, true, false, "cannot join " + group + ": " + reason});
  }
}

void Memberships::succeed(const Memberships& former) {
  for (const auto& [group, membership] : former.memberships_) {
    Membership& kept = memberships_[group];
    kept.wanted = membership.wanted && !membership.after_leave;
    kept.left = membership.left;
  }
}

}  // namespace adhoc_communication::multicast
