#include "multicast/distribution.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication::multicast {

Distribution::Distribution(const GroupPacket& packet, transport::RoundTrip& round_trip, std::uint8_t first_parity)
    : packet_(packet), round_trip_(round_trip), first_parity_(first_parity), sent_(packet.blocks().size()) {}

void Distribution::set_children(const std::map<MacAddress, std::uint32_t>& children, bool anew, Time now) {
  for (auto iterator = children_.begin(); iterator != children_.end();) {
    const bool stays = !anew && children.count(iterator->first) != 0;
    iterator = stays ? std::next(iterator) : children_.erase(iterator);
  }
  for (const auto& [address, coverage] : children) {
    const bool known = children_.count(address) != 0;
    Child& child = children_[address];
    if (known && child.coverage == coverage) continue;
    child.coverage = coverage;
    child.done = false;
    child.progress = now;
    child.asked = now;
    child.question_wait = round_trip_.timeout();
    if (known) continue;
    child.missing.assign(sent_.size(), kUnknown);
    child.known_in.assign(sent_.size(), 0);
  }
}

bool Distribution::done() const {
  return std::all_of(children_.begin(), children_.end(), [](const auto& item) { return item.second.done; });
}

bool Distribution::begun() const {
  return std::any_of(sent_.begin(), sent_.end(), [](const Sent& sent) { return sent.frames.any(); });
}

std::optional<MacAddress> Distribution::only_open_child() const {
  std::optional<MacAddress> only;
  for (const auto& [address, child] : children_) {
    if (child.done) continue;
    if (only) return std::nullopt;
    only = address;
  }
  return only;
}

/// Whether a child still misses something of the block, as far as is known.
bool Distribution::open(std::size_t block) const {
  return std::any_of(children_.begin(), children_.end(),
                     [&](const auto& item) { return item.second.takes() && item.second.missing[block] != 0; });
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
        return Place{block, frame};
      }
    }
  }
  return std::nullopt;
}

Distribution::Outgoing Distribution::next(Time now) {
  Place place{};
  if (!repairs_.empty()) {
    place = repairs_.back();
    repairs_.pop_back();
    --sent_[place.block].repairs_planned;
  } else {
    place = *next_unsent();
    Sent& sent = sent_[place.block];
    sent.frames.set(static_cast<std::size_t>(place.symbol));
    sent.all = static_cast<int>(sent.frames.count()) == packet_.blocks()[place.block].frames();
  }
  sent_[place.block].round = round_;
  Outgoing outgoing{place.block, place.symbol, false, round_};
  ++since_question_;
  outgoing.question = since_question_ >= kFramesPerQuestion || (!has_frame() && nothing_to_come());
  if (outgoing.question) close_round(now);
  return outgoing;
}

/// A relay that is in the middle of a block waits for the rest before it asks.
bool Distribution::nothing_to_come() const {
  return std::none_of(sent_.begin(), sent_.end(), [](const Sent& sent) { return sent.frames.any() && !sent.all; });
}

void Distribution::close_round(Time now) {
  since_question_ = 0;
  asked_ = now;
  timing_ = true;
  for (auto& [address, child] : children_) {
    child.asked = now;
    child.question_wait = round_trip_.timeout();
  }
  ++round_;
}

std::uint16_t Distribution::question_round() {
  timing_ = false;  // which question is answered is not known any more (Karn)
  return round_++;
}

bool Distribution::reported(const MacAddress& from, const wire::GroupReport& report, bool covers_all, Time now) {
  const auto found = children_.find(from);
  if (found == children_.end()) return false;
  Child& child = found->second;
  if (child.done) return true;
  if (report.first_block == wire::kNoRoom) {
    wait_for_room(child, now);
    return false;
  }
  if (std::exchange(child.no_room_since, std::nullopt)) child.progress = now;
  if (report.round + 1 == round_) {
    if (timing_ && asked_) round_trip_.sample(now - *asked_);
    timing_ = false;
    child.asked = now;
    child.question_wait = kSubtreePatience;
  }
  const auto learn = [&](std::size_t block, std::uint8_t missing) {
    if (report.round < child.known_in[block]) return;
    if (missing < child.missing[block]) child.progress = now;
    child.missing[block] = missing;
    child.known_in[block] = report.round;
  };
  for (std::size_t block = 0; block < std::min<std::size_t>(report.first_block, sent_.size()); ++block) learn(block, 0);
  for (std::size_t i = 0; i < report.missing.size() && report.first_block + i < sent_.size(); ++i) {
    learn(report.first_block + i, report.missing[i]);
  }
  if (report.complete && covers_all) child.done = true;
  for (std::size_t block = 0; block < sent_.size(); ++block) plan_repairs(block, overdue(now));
  return child.done;
}

/// Nothing that it has had counts any more.
void Distribution::wait_for_room(Child& child, Time now) {
  if (!child.no_room_since) child.no_room_since = now;
  child.asked = now;
  child.question_wait = kRoomRetry;
  child.missing.assign(sent_.size(), kUnknown);
  child.known_in.assign(sent_.size(), 0);
}

/// What it said counts everything that was sent of the block.
bool Distribution::knows(const Child& child, std::size_t block) const {
  return child.missing[block] == 0 || (child.missing[block] != kUnknown && child.known_in[block] >= sent_[block].round);
}

void Distribution::plan_repairs(std::size_t block, bool overdue) {
  Sent& sent = sent_[block];
  if (!sent.all || sent.repairs_planned > 0 || !packet_.blocks()[block].complete()) return;
  int most = 0;
  std::uint8_t bits = 0;
  for (const auto& [address, child] : children_) {
    if (!child.takes()) continue;
    if (!knows(child, block)) {
      if (!overdue) return;
      continue;
    }
    most = std::max<int>(most, child.missing[block]);
    bits = static_cast<std::uint8_t>(bits | child.missing[block]);
  }
  if (most == 0) return;
  if (packet_.blocks()[block].frames() <= kMostRepeatedFrames) {
    repeat_frames(block, bits);
  } else {
    fresh_parity(block, std::min(most, packet_.blocks()[block].frames()));
  }
}

void Distribution::repeat_frames(std::size_t block, std::uint8_t missing) {
  for (int frame = packet_.blocks()[block].frames() - 1; frame >= 0; --frame) {
    if ((missing >> frame & 1) == 0) continue;
    repairs_.push_back({block, frame});
    ++sent_[block].repairs_planned;
  }
}

/// Each round takes symbols not sent before; after kSymbols of them the oldest come again.
void Distribution::fresh_parity(std::size_t block, int count) {
  const int frames = packet_.blocks()[block].frames();
  const int parities = kSymbols - frames;
  Sent& sent = sent_[block];
  for (int i = 0; i < count; ++i) {
    repairs_.push_back({block, frames + (first_parity_ + sent.next_parity++) % parities});
    ++sent.repairs_planned;
  }
}

std::vector<MacAddress> Distribution::poll(Time now) {
  std::vector<MacAddress> to_ask;
  if (has_frame() || !packet_.complete()) return to_ask;
  if (overdue(now)) {
    for (std::size_t block = 0; block < sent_.size(); ++block) plan_repairs(block, true);
    if (!repairs_.empty()) return to_ask;
  }
  for (auto& [address, child] : children_) {
    if (child.done || now < child.asked + child.question_wait) continue;
    child.asked = now;
    child.question_wait = child.no_room_since ? kRoomRetry : std::min<Time>(2 * child.question_wait, kSubtreePatience);
    to_ask.push_back(address);
  }
  return to_ask;
}

std::vector<MacAddress> Distribution::stuck(Time now) const {
  std::vector<MacAddress> result;
  if (!packet_.complete()) return result;
  for (const auto& [address, child] : children_) {
    if (child.done) continue;
    const bool waits =
        std::all_of(child.missing.begin(), child.missing.end(), [](auto missing) { return missing == 0; });
    const bool stuck = child.no_room_since ? now - *child.no_room_since >= kRoomPatience
                                           : now - child.progress >= (waits ? kNoEnd : kNoProgress);
    if (stuck) result.push_back(address);
  }
  return result;
}

Time Distribution::next_deadline() const {
  if (has_frame() || !packet_.complete()) return Time::max();
  Time next = Time::max();
  for (const auto& [address, child] : children_) {
    if (!child.done) next = std::min(next, child.asked + child.question_wait);
  }
  return next;
}

}  // namespace adhoc_communication::multicast
