#include "multicast/distribution.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication::multicast {

Distribution::Distribution(const GroupPacket& packet, transport::RoundTrip& round_trip, std::uint8_t first_parity)
    : packet_(packet), rounds_(round_trip), first_parity_(first_parity), sent_(packet.blocks().size()) {}

void Distribution::set_children(const std::map<MacAddress, std::uint32_t>& children, bool anew, Time now) {
  for (auto iterator = children_.begin(); iterator != children_.end();) {
    const bool stays = !anew && children.count(iterator->first) != 0;
    iterator = stays ? std::next(iterator) : children_.erase(iterator);
  }
  std::vector<std::uint16_t> sent_in;
  for (const Sent& sent : sent_) sent_in.push_back(sent.round);
  for (const auto& [address, coverage] : children) {
    const auto known = children_.find(address);
    if (known == children_.end()) {
      children_.emplace(address, Child(sent_in, coverage, rounds_.patience(), now));
    } else if (known->second.coverage() != coverage) {
      known->second.cover(coverage, rounds_.patience(), now);
    }
  }
  prune_run(now);
}

bool Distribution::done() const {
  return std::all_of(children_.begin(), children_.end(), [](const auto& item) { return item.second.done(); });
}

bool Distribution::begun() const {
  return std::any_of(sent_.begin(), sent_.end(), [](const Sent& sent) { return sent.frames.any(); });
}

std::optional<MacAddress> Distribution::only_open_child() const {
  std::optional<MacAddress> only;
  for (const auto& [address, child] : children_) {
    if (child.done()) continue;
    if (only) return std::nullopt;
    only = address;
  }
  return only;
}

/// Whether a child still misses something of the block, as far as is known.
bool Distribution::open(std::size_t block) const {
  return std::any_of(children_.begin(), children_.end(),
                     [&](const auto& item) { return item.second.takes() && item.second.misses(block); });
}

std::size_t Distribution::window_end() const {
  std::size_t begin = 0;
  while (begin < sent_.size() && sent_[begin].all && !open(begin)) ++begin;
  return std::min(begin + kWindow, sent_.size());
}

std::optional<Distribution::Place> Distribution::next_unsent() const {
  if (std::none_of(children_.begin(), children_.end(), [](const auto& item) { return item.second.takes(); })) {
    return std::nullopt;
  }
  const std::size_t end = window_end();
  for (std::size_t block = end > kWindow ? end - kWindow : 0; block < end; ++block) {
    if (sent_[block].all) continue;
    for (int frame = 0; frame < packet_.blocks()[block].frames(); ++frame) {
      if (!sent_[block].frames.test(static_cast<std::size_t>(frame)) && packet_.blocks()[block].has_frame(frame)) {
        return Place{block, frame, {}};
      }
    }
  }
  return std::nullopt;
}

Distribution::Place Distribution::next_symbol() const { return repairs_.empty() ? *next_unsent() : repairs_.back(); }

/// It is sent now.
void Distribution::take_symbol(const Place& place) {
  Sent& sent = sent_[place.block];
  if (!repairs_.empty()) {
    repairs_.pop_back();
    --sent.repairs_planned;
  } else {
    sent.frames.set(static_cast<std::size_t>(place.symbol));
    sent.all = static_cast<int>(sent.frames.count()) == packet_.blocks()[place.block].frames();
  }
  sent.round = rounds_.number();
  rounds_.sent();
  trials_.sent();
}

/// Children that need the symbol: of one not sent before, all that take any.
std::vector<MacAddress> Distribution::takers(const Place& place) const {
  std::vector<MacAddress> result;
  for (const auto& [address, child] : children_) {
    const bool named =
        place.targets.empty() || std::find(place.targets.begin(), place.targets.end(), address) != place.targets.end();
    if (named && child.takes() && child.misses(place.block)) result.push_back(address);
  }
  return result;
}

/// Those of them that are sure to be sent.
std::size_t Distribution::frames_left() const {
  std::size_t frames = repairs_.size();
  for (std::size_t block = 0; block < sent_.size(); ++block) {
    frames += static_cast<std::size_t>(packet_.blocks()[block].frames()) - sent_[block].frames.count();
  }
  return frames;
}

/// Of the next symbol.
Way Distribution::way(const Carriage& carriage, Time now) const {
  const std::vector<MacAddress> targets = takers(next_symbol());
  if (targets.empty()) return Way::kBroadcast;
  const Way way = carriage.way(targets, frames_left(), now);
  return way == Way::kTrial && !trials_.due() ? Way::kBroadcast : way;
}

Distribution::Outgoing Distribution::next(const Carriage& carriage, Time now) {
  if (run_.empty()) {
    switch (way(carriage, now)) {
      case Way::kBroadcast:
        send_to_all(carriage, now);
        break;
      case Way::kUnicasts:
        send_to_each(carriage, kRun, now);
        break;
      case Way::kTrial:
        trials_.begun();
        send_to_each(carriage, kTrial, now);
        break;
    }
  }
  const Outgoing outgoing = run_.front();
  run_.pop_front();
  if (outgoing.child && outgoing.question) children_.at(*outgoing.child).asked(rounds_.patience(), now);
  if (run_.empty()) close_run(now);
  return outgoing;
}

bool Distribution::round_is_full() const {
  return rounds_.frames() >= kFramesPerQuestion || (!has_symbol() && nothing_to_come());
}

bool Distribution::question_due(const Carriage& carriage, Time now) const {
  if (round_is_full()) return true;
  if (children_.size() < 2 || frames_left() < Carriage::kWorthATrial || carriage.knows_broadcasts(now)) return false;
  return rounds_.frames() >= (measures_at_first(carriage) ? kFramesOfFirstMeasure : kFramesOfMeasure);
}

/// Nothing is known of broadcasts: it is worth to wait for an answer, since they may be far too dear.
bool Distribution::measures_at_first(const Carriage& carriage) const {
  return measures_ < kFirstMeasures && !carriage.has_measured_broadcasts();
}

void Distribution::send_to_all(const Carriage& carriage, Time now) {
  const bool again = !repairs_.empty();
  const Place place = next_symbol();
  take_symbol(place);
  for (auto& [address, child] : children_) child.sent(place.block, rounds_.number());
  Outgoing outgoing{place.block, place.symbol, question_due(carriage, now), rounds_.number(), std::nullopt, again};
  if (outgoing.question) {
    const bool early = rounds_.frames() < kFramesPerQuestion && has_symbol();
    awaited_ = early && measures_at_first(carriage) ? 1 : 0;
    measures_ += early ? 1 : 0;
    rounds_.close(now);
    for (auto& [address, child] : children_) child.asked(rounds_.patience(), now);
  }
  run_.push_back(outgoing);
}

/// Up to `most` symbols, as long as that way is the cheaper one for them; of a trial, all of them.
void Distribution::send_to_each(const Carriage& carriage, std::size_t most, Time now) {
  std::map<MacAddress, std::vector<Outgoing>> copies;
  for (std::size_t count = 0; count < most && has_symbol(); ++count) {
    if (most == kRun && way(carriage, now) != Way::kUnicasts) break;
    const bool again = !repairs_.empty();
    const Place place = next_symbol();
    take_symbol(place);
    for (const MacAddress& target : takers(place)) {
      children_.at(target).sent(place.block, rounds_.number());
      copies[target].push_back({place.block, place.symbol, false, rounds_.number(), target, again});
    }
  }
  const bool question = most == kTrial || round_is_full();
  for (auto& [target, outgoing] : copies) {
    outgoing.back().question = question;
    run_.insert(run_.end(), outgoing.begin(), outgoing.end());
  }
  if (!question) return;
  rounds_.close(now);
  rounds_.ask_later();
  run_asks_ = true;
  if (most == kTrial) awaited_ = copies.size();
}

/// All questions of a round are out.
void Distribution::close_run(Time now) {
  if (std::exchange(run_asks_, false)) rounds_.asked(now);
}

/// What was to go to children that take nothing any more.
void Distribution::prune_run(Time now) {
  const auto is_useless = [this](const Outgoing& outgoing) {
    if (!outgoing.child) return false;
    const auto child = children_.find(*outgoing.child);
    return child == children_.end() || !child->second.takes();
  };
  run_.erase(std::remove_if(run_.begin(), run_.end(), is_useless), run_.end());
  if (run_.empty()) close_run(now);
}

/// A relay that is in the middle of a block waits for the rest before it asks.
bool Distribution::nothing_to_come() const {
  return std::none_of(sent_.begin(), sent_.end(), [](const Sent& sent) { return sent.frames.any() && !sent.all; });
}

bool Distribution::reported(const MacAddress& from, const wire::GroupReport& report, bool covers_all, Time now) {
  const auto found = children_.find(from);
  if (found == children_.end()) return false;
  Child& child = found->second;
  if (child.done()) return true;
  if (report.first_block == wire::kNoRoom) {
    child.wait_for_room(now);
    prune_run(now);
    return false;
  }
  child.has_room(now);
  if (rounds_.answered(report.round, child.asked_at(), now)) {
    awaited_ -= awaited_ > 0 ? 1 : 0;
    child.answered(now);
  }
  child.learn(report, now);
  if (report.complete && covers_all) child.finish();
  if (child.done()) prune_run(now);
  for (std::size_t block = 0; block < sent_.size(); ++block) plan_repairs(block, rounds_.overdue(now));
  return child.done();
}

void Distribution::plan_repairs(std::size_t block, bool overdue) {
  Sent& sent = sent_[block];
  if (!sent.all || sent.repairs_planned > 0 || !packet_.blocks()[block].complete()) return;
  std::map<MacAddress, std::uint8_t> missing;
  for (const auto& [address, child] : children_) {
    if (!child.takes()) continue;
    if (!child.knows(block)) {
      if (!overdue) return;
      continue;
    }
    if (child.misses(block)) missing[address] = child.missing(block);
  }
  if (packet_.blocks()[block].frames() <= kMostRepeatedFrames) {
    repeat_frames(block, missing);
  } else {
    fresh_parity(block, missing);
  }
}

void Distribution::repeat_frames(std::size_t block, const std::map<MacAddress, std::uint8_t>& missing) {
  for (int frame = packet_.blocks()[block].frames() - 1; frame >= 0; --frame) {
    Place place{block, frame, {}};
    for (const auto& [address, bits] : missing) {
      if ((bits >> frame & 1) != 0) place.targets.push_back(address);
    }
    if (!place.targets.empty()) plan_repair(std::move(place));
  }
}

void Distribution::plan_repair(Place place) {
  ++sent_[place.block].repairs_planned;
  repairs_.push_back(std::move(place));
}

/// Each round takes symbols not sent before; after kSymbols of them the oldest come again.
void Distribution::fresh_parity(std::size_t block, const std::map<MacAddress, std::uint8_t>& missing) {
  const int frames = packet_.blocks()[block].frames();
  const int parities = kSymbols - frames;
  for (int i = 0; i < frames; ++i) {
    Place place{block, frames + (first_parity_ + sent_[block].next_parity) % parities, {}};
    for (const auto& [address, count] : missing) {
      if (count > i) place.targets.push_back(address);
    }
    if (place.targets.empty()) return;
    ++sent_[block].next_parity;
    plan_repair(std::move(place));
  }
}

void Distribution::add_open(std::set<MacAddress>& children) const {
  for (const auto& [address, child] : children_) {
    if (!child.done()) children.insert(address);
  }
}

std::vector<MacAddress> Distribution::poll(const std::set<MacAddress>& behind, Time now) {
  std::vector<MacAddress> to_ask;
  if (rounds_.overdue(now)) awaited_ = 0;
  if (has_frame() || !packet_.complete()) return to_ask;
  if (rounds_.overdue(now)) {
    for (std::size_t block = 0; block < sent_.size(); ++block) plan_repairs(block, true);
    if (!repairs_.empty()) return to_ask;
  }
  for (auto& [address, child] : children_) {
    if (child.done() || now < child.due()) continue;
    child.asked_by_itself(now);
    if (!child.misses_nothing() || behind.count(address) == 0) to_ask.push_back(address);
  }
  return to_ask;
}

std::vector<MacAddress> Distribution::stuck(Time now) const {
  std::vector<MacAddress> result;
  if (!packet_.complete()) return result;
  for (const auto& [address, child] : children_) {
    if (child.stuck(now)) result.push_back(address);
  }
  return result;
}

Time Distribution::next_deadline() const {
  if (awaited_ > 0 && rounds_.due()) return *rounds_.due();
  if (has_frame() || !packet_.complete()) return Time::max();
  Time next = Time::max();
  for (const auto& [address, child] : children_) {
    if (!child.done()) next = std::min(next, child.due());
  }
  return next;
}

}  // namespace adhoc_communication::multicast
