#include "routing/living_runs.hpp"

#include <algorithm>
#include <utility>

#include "routing/sequence_number.hpp"

namespace adhoc_communication::routing {

void LivingRuns::beacon(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now) {
  const auto known = robots_.find(robot);
  FormerRun* run = known == robots_.end() ? nullptr : former(known->second, boot);
  if (run == nullptr || !in_step(*run, sign, kBeaconDelay, now)) return;
  // Sooner, the delay alone would let anything pass.
  if (now - run->signed_at > kBeaconDelay) run->alive_at = now;
}

bool LivingRuns::heard(const MacAddress& robot, wire::BootTag boot, std::uint64_t counter, Time now, bool answers) {
  Runs& runs = runs_of(robot, boot, now);
  if (runs.boot != boot) {
    if (FormerRun* run = former(runs, boot)) {
      if (counter <= run->counter) return false;
      run->counter = counter;
      if (now - run->alive_at >= kHeardRecently) return false;
    }
    if (!gives_way(runs, answers, now)) return false;
    displace(runs, boot);
  }
  if (answers && runs.rival.doubted) {
    runs.rival.doubted.reset();
    runs.rival.trusted_until = now + kTrust;
  }
  runs.heard = now;
  runs.news = now;
  runs.counter = std::max(runs.counter, counter);
  return true;
}

/// Another run is heard.
bool LivingRuns::gives_way(Runs& runs, bool to_who_answers, Time now) {
  if (now - runs.heard >= kGone) return true;
  Rival& rival = runs.rival;
  if (now - rival.last >= kHeardRecently) rival.since = now;
  doubt(rival, now);
  rival.last = now;
  last_rival_ = now;
  if (!rival.doubted) return false;
  if (!rival.two_way && *rival.doubted < now && now - runs.heard >= kHeardRecently) return true;
  const Time silence = now - std::max(runs.heard, *rival.doubted);
  const bool asked = asks_ && rival.asked >= *rival.doubted;
  if (rival.two_way && !asked) return silence >= kUnheardUnasked;
  const int patience = to_who_answers ? 1 : 2;
  return silence >= patience * kUnheard || now - *rival.doubted >= patience * kUnanswered;
}

/// What began long ago, and was not settled, begins anew.
void LivingRuns::doubt(Rival& rival, Time now) {
  if (now < rival.trusted_until) return;
  if (rival.doubted && now - std::max(*rival.doubted, rival.last) < kHeardRecently) return;
  rival.doubted = now;
  rival.two_way = false;
}

void LivingRuns::suspected(const MacAddress& robot, wire::BootTag boot, Time now) {
  const auto found = robots_.find(robot);
  if (found == robots_.end() || found->second.boot == boot || now - found->second.heard >= kGone) return;
  doubt(found->second.rival, now);
}

bool LivingRuns::wants_answer(const MacAddress& robot, bool two_way, Time now) {
  const auto found = robots_.find(robot);
  if (found == robots_.end()) return false;
  Rival& rival = found->second.rival;
  if (!rival.doubted || now - std::max(*rival.doubted, rival.last) >= kUnanswered) return false;
  rival.two_way = rival.two_way || two_way;
  if (!asks_ || !rival.two_way || now - rival.asked < kAskAgain || !questions_.take(now)) return false;
  rival.asked = now;
  return true;
}

bool LivingRuns::contested(const MacAddress& robot, Time now) const {
  const auto found = robots_.find(robot);
  if (found == robots_.end()) return false;
  const Rival& rival = found->second.rival;
  return now - rival.last < kHeardRecently && rival.last - rival.since >= kContested;
}

bool LivingRuns::told(const MacAddress& robot, wire::BootTag boot, Time now) {
  Runs& runs = runs_of(robot, boot, now);
  if (runs.boot == boot) {
    runs.news = now;
    return true;
  }
  if (now - runs.heard < kHeardRecently || former(runs, boot) != nullptr) return false;
  if (runs.reinstated && now - runs.defended < kHeardRecently) return false;
  // Who was told of by requests only has no life sign, so a chain of such runs does not put off the one that lives.
  if (runs.sign != 0) runs.defended = now;
  displace(runs, boot);
  runs.news = now;
  return true;
}

bool LivingRuns::told_alive(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now) {
  const auto known = robots_.find(robot);
  if (known != robots_.end() && known->second.boot != boot) {
    Runs& runs = known->second;
    const bool lives_elsewhere = now - runs.heard < kHeardRecently;
    if (FormerRun* run = former(runs, boot)) {
      const bool grown = run->sign != 0 && is_newer(sign, run->sign + kSecondsThatProveLife);
      const bool goes_on = in_step(*run, sign, kRumorDelay, now) && grown;
      if (lives_elsewhere || !goes_on || now - runs.defended < kHeardRecently) return false;
      displace(runs, boot);
      runs.reinstated = true;
    }
  }
  if (!told(robot, boot, now)) return false;
  Runs& runs = robots_.at(robot);
  if (runs.measure.value == 0) runs.measure = {sign, now};
  if (runs.sign == 0 || is_newer(sign, runs.sign)) believe(runs, sign, now);
  return true;
}

/// One that is behind may be late or recorded. Where the robot has told its sign before, what others told is too great
/// by little, and the time makes up for it.
bool LivingRuns::said_alive(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now) {
  if (!told(robot, boot, now)) return false;
  Runs& runs = robots_.at(robot);
  const bool behind = runs.sign != 0 && is_newer(runs.sign, sign);
  const bool disputed = !runs.measured_itself || now - runs.defended >= kHeardRecently;
  if (behind && !(disputed && goes_on(runs.said_below, sign, now))) return true;
  runs.measure = {sign, now};
  runs.measured_itself = true;
  runs.said_below = {};
  if (sign != runs.sign) believe(runs, sign, now);
  return true;
}

std::uint32_t LivingRuns::credible(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now) const {
  const auto found = robots_.find(robot);
  if (found == robots_.end() || found->second.boot != boot || found->second.measure.value == 0) return sign;
  const Runs& runs = found->second;
  const Time margin = now - runs.heard < kHeardRecently ? kBeaconDelay : kRumorDelay;
  const auto growth = (now - runs.measure.at + margin) / std::chrono::seconds(1);
  const std::uint32_t most = runs.measure.value + static_cast<std::uint32_t>(growth);
  return is_newer(sign, most) ? most : sign;
}

bool LivingRuns::goes_on_below(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now) {
  const auto found = robots_.find(robot);
  if (found == robots_.end() || found->second.boot != boot) return false;
  Runs& runs = found->second;
  if (now - runs.defended < kHeardRecently || !goes_on(runs.below, sign, now)) return false;
  runs.measure = {sign, now};
  runs.measured_itself = false;
  believe(runs, sign, now);
  return true;
}

/// Signs below the one believed have grown with time.
bool LivingRuns::goes_on(Sign& below, std::uint32_t sign, Time now) {
  if (below.value == 0 || now - below.at >= kRumorDelay) {
    below = {sign, now};
    return false;
  }
  const std::chrono::seconds grown(static_cast<std::int32_t>(sign - below.value));
  return grown <= now - below.at + kBeaconDelay && is_newer(sign, below.value + kSecondsThatProveLife);
}

void LivingRuns::believe(Runs& runs, std::uint32_t sign, Time now) {
  runs.sign = sign;
  runs.signed_at = now;
  runs.defended = now;
  runs.below = {};
}

bool LivingRuns::lives(const MacAddress& robot, wire::BootTag boot) const {
  const auto found = robots_.find(robot);
  return found != robots_.end() && found->second.boot == boot;
}

std::uint32_t LivingRuns::life_sign(const MacAddress& robot) const {
  const auto found = robots_.find(robot);
  return found == robots_.end() ? 0 : found->second.sign;
}

std::uint32_t LivingRuns::life_sign(const MacAddress& robot, wire::BootTag boot) const {
  const auto found = robots_.find(robot);
  return found == robots_.end() || found->second.boot != boot ? 0 : found->second.sign;
}

bool LivingRuns::heard_lately(const MacAddress& robot, Time now) const {
  const auto found = robots_.find(robot);
  return found != robots_.end() && now - found->second.heard < kHeardRecently;
}

/// News only get later, so none is forgotten before the oldest of the last look is due.
void LivingRuns::expire(Time now) {
  if (now < next_expiry_) return;
  next_expiry_ = now + kForget;
  for (auto runs = robots_.begin(); runs != robots_.end();) {
    const Time due = runs->second.news + kForget;
    if (due > now) next_expiry_ = std::min(next_expiry_, due);
    runs = due <= now ? robots_.erase(runs) : std::next(runs);
  }
}

LivingRuns::Runs& LivingRuns::runs_of(const MacAddress& robot, wire::BootTag boot, Time now) {
  if (const auto found = robots_.find(robot); found != robots_.end()) return found->second;
  make_room(now);
  Runs& runs = robots_[robot];
  runs.boot = boot;
  return runs;
}

void LivingRuns::make_room(Time now) {
  if (robots_.size() < kMostRobots) return;
  robots_.erase(std::min_element(robots_.begin(), robots_.end(), [now](const auto& a, const auto& b) {
    const auto worth = [now](const Runs& runs) { return std::pair(now - runs.heard < kHeardRecently, runs.news); };
    return worth(a.second) < worth(b.second);
  }));
}

LivingRuns::FormerRun* LivingRuns::former(Runs& runs, wire::BootTag boot) {
  const auto found =
      std::find_if(runs.former.begin(), runs.former.end(), [boot](const FormerRun& run) { return run.boot == boot; });
  return found == runs.former.end() ? nullptr : &*found;
}

/// Whether the run can have lived until shortly before now, by a sign known since a while ago. The first one that is
/// heard of tells nothing.
bool LivingRuns::in_step(FormerRun& run, std::uint32_t sign, Time delay, Time now) {
  if (run.sign == 0) {
    run.sign = sign;
    run.signed_at = now;
    return false;
  }
  const std::chrono::seconds lived(static_cast<std::int32_t>(sign - run.sign));
  return lived + delay >= now - run.signed_at;
}

/// Those of which nothing but a claim was heard go first: any number of them can be made up.
void LivingRuns::forget_one(Runs& runs) {
  const auto claim = std::find_if(runs.former.begin(), runs.former.end(),
                                  [](const FormerRun& run) { return run.sign == 0 && run.counter == 0; });
  runs.former.erase(claim == runs.former.end() ? runs.former.begin() : claim);
}

void LivingRuns::displace(Runs& runs, wire::BootTag boot) {
  FormerRun next;
  if (const FormerRun* known = former(runs, boot)) next = *known;
  runs.former.erase(
      std::remove_if(runs.former.begin(), runs.former.end(), [boot](const FormerRun& run) { return run.boot == boot; }),
      runs.former.end());
  runs.former.push_back({runs.boot, runs.sign, runs.signed_at, runs.counter, runs.heard});
  if (runs.former.size() > kMostFormerRuns) forget_one(runs);
  runs.boot = boot;
  runs.sign = next.sign;
  runs.signed_at = next.signed_at;
  runs.measure = {next.sign, next.signed_at};
  runs.measured_itself = false;
  runs.below = {};
  runs.said_below = {};
  runs.counter = next.counter;
  runs.reinstated = false;
  runs.heard = -kGone;
  runs.rival = {};
}

}  // namespace adhoc_communication::routing
