#include "transport/hops.hpp"

#include <algorithm>

#include "round_robin.hpp"
#include "transport/data_count.hpp"

namespace adhoc_communication::transport {

using wire::FrameType;

namespace {

constexpr Time kLatestAcknowledgment = std::chrono::milliseconds(50);
constexpr Time kLongestBacklog = std::chrono::milliseconds(20);

/// What is most urgent waits for nobody's turn.
bool is_urgent(std::uint8_t priority) { return priority == static_cast<std::uint8_t>(Priority::kControl); }

/// On a way of so many hops.
bool takes_turns(std::uint8_t route, std::uint8_t priority) {
  return route >= TurnTaking::kShortestRoute && !is_urgent(priority);
}

}  // namespace

Hops::Hops(const Identity& self, const EngineOptions& options, routing::Neighbors& neighbors,
           const routing::RobotDirectory& directory, air::AirClock& air, air::Transmitter& transmitter,
           Journal& journal, Statistics& statistics)
    : self_(self),
      options_(options),
      neighbors_(neighbors),
      air_(air),
      transmitter_(transmitter),
      statistics_(statistics),
      passed_(self, directory, journal) {}

Hops::Hop& Hops::hop(const MacAddress& neighbor) {
  return hops_.use(neighbor, [this] {
    // Link sequences begin where the frame counter stands, so that a hop that was forgotten never repeats one.
    const auto first = static_cast<std::uint32_t>(transmitter_.next_counter());
    return Hop{HopSender(first, options_.num_link_retrans), std::nullopt, {}, 1};
  });
}

void Hops::broadcast(FrameType type, Bytes body, Time now) { transmitter_.transmit(type, wire::kEverybody, body, now); }

void Hops::unicast(const MacAddress& neighbor, FrameType type, Bytes body) {
  if (neighbors_.find(neighbor) == nullptr) return;  // gone; a hop to it would never be removed
  enqueue(neighbor, {type, std::move(body), static_cast<std::uint8_t>(Priority::kControl)});
}

void Hops::unicast_once(const MacAddress& neighbor, FrameType type, Bytes body, Time now) {
  transmitter_.transmit(type, neighbor, body, now);
}

void Hops::enqueue(const MacAddress& neighbor, HopFrame frame) {
  HopSender& next = hop(neighbor).sender;
  if (takes_turns(frame.route, frame.priority)) follow(frame, next);
  next.enqueue(std::move(frame));
}

/// Where frames are lost to the next robot, a turn could not come back in time.
void Hops::follow(const HopFrame& frame, const HopSender& next) {
  const bool comes_back = TurnTaking::comes_back(frame.route);
  if (comes_back && !next.reliable()) return turns_.follow_no_more(frame.previous_hop);
  turns_.follow(frame.previous_hop, comes_back);
}

// --- frames in -------------------------------------------------------------------------------------------------------

void Hops::heard(const MacAddress& neighbor, Time now) {
  if (Hop* known = hops_.find(neighbor)) known->sender.heard(now);
}

bool Hops::take(const wire::FrameHeader& header, Time now) {
  const wire::BootTag boot = wire::boot_tag(header.boot_id);
  Hop& from = hop(header.sender);
  if (!from.receiver || from.receiver->boot() != boot) from.receiver.emplace(boot);
  const bool at_once = (header.flags & wire::kAcknowledgeNow) != 0;
  if (header.type == FrameType::kData) {
    turns_.heard(header.sender, at_once, air_.undisturbed_frame_time(header.sender), now);
  }
  from.receiver->delay(delays(header.sender));
  if (from.receiver->take(header.link_sequence, header.counter, at_once, now)) return true;
  ++statistics_.frames_received_again;
  return false;
}

void Hops::on_acknowledgment(const MacAddress& from, const wire::HopAcknowledgment& acknowledgment, Time now) {
  if (acknowledgment.boot != self_.boot) return;
  neighbors_.acknowledged(from, now);
  air_.acknowledged(acknowledgment.newest_counter, Time(acknowledgment.spacing_ns), now - Time(acknowledgment.held_ns),
                    kAcknowledgmentOctets);
  turns_.answered(from, acknowledgment.newest_counter, now);
  Hop& answering = hop(from);
  if (answering.sender.asked(acknowledgment.newest_counter)) {
    answering.held_answers.count(Time(acknowledgment.held_ns), air_.undisturbed_frame_time(from));
  }
  std::vector<HopSender::Passed> passed;
  answering.sender.acknowledged(acknowledgment, now, passed_.wanted() ? &passed : nullptr);
  passed_.add(from, passed, now);
}

// --- what is due -----------------------------------------------------------------------------------------------------

void Hops::excuse_silence(Time now) {
  for (const auto& [neighbor, hop] : hops_.busy()) hop->sender.excuse_silence(now);
}

std::vector<MacAddress> Hops::expire(Time now) {
  std::vector<MacAddress> dead;
  for (const auto& [neighbor, hop] : hops_.busy()) {
    hop->sender.expire(now);
    if (hop->sender.dead(now)) dead.push_back(neighbor);
  }
  return dead;
}

AcknowledgmentDelays Hops::delays(const MacAddress& neighbor) const {
  return AcknowledgmentDelays::of(air_.calibrated(neighbor) ? air_.undisturbed_frame_time(neighbor) : Time(0));
}

/// Turns of the neighbour wait for what came from it to be with the next robot.
bool Hops::passes_on(const MacAddress& neighbor) const {
  return std::any_of(hops_.busy().begin(), hops_.busy().end(), [&](const auto& item) {
    const HopSender& sender = item.second->sender;
    return sender.reliable() && sender.passes_on(neighbor);
  });
}

/// On a crowded channel one later acknowledgment for many frames is better than a queue of them in the radio.
Time Hops::acknowledgment_due(const MacAddress& neighbor, const HopReceiver& receiver) const {
  Time due = receiver.due();
  if (due == Time::max()) return due;
  if (air_.shared(due)) {
    const Time ends = turns_.ends(neighbor);
    due = std::max(due, ends > Time(0) && passes_on(neighbor) ? turns_.held_until(neighbor) : ends);
  }
  return std::max(due, std::min(air_.ready_at(), receiver.owed_since() + kLatestAcknowledgment));
}

void Hops::acknowledge(Time now) {
  for (const auto& [neighbor, hop] : hops_.busy()) {
    if (!hop->receiver || acknowledgment_due(neighbor, *hop->receiver) > now) continue;
    if (air_.shared(now)) send_urgent(neighbor, *hop, now);
    transmitter_.transmit(FrameType::kHopAcknowledgment, neighbor, to_bytes(hop->receiver->acknowledge(now)), now);
  }
}

/// The answer may begin the turn of a robot that does not hear this one: what is to go there as well goes before.
void Hops::send_urgent(const MacAddress& neighbor, Hop& hop, Time now) {
  constexpr auto kUrgent = static_cast<std::uint8_t>(Priority::kControl);
  const MacAddress own{};
  while (hop.sender.has_waiting(kUrgent, own) && hop.sender.may_start() && air_allows(neighbor, hop, kUrgent, now)) {
    start(neighbor, hop, hop.sender.take_waiting(kUrgent, own), now);
  }
}

Time Hops::next_deadline(Time now) const {
  Time next = air_.shared(now) ? turns_.next_opening(now) : Time::max();
  for (const auto& [neighbor, hop] : hops_.busy()) {
    next = std::min(next, hop->sender.next_deadline());
    if (hop->receiver) next = std::min(next, acknowledgment_due(neighbor, *hop->receiver));
  }
  return next;
}

void Hops::settle() {
  hops_.settle([](const Hop& hop) { return hop.idle(); });
}

std::vector<HopFrame> Hops::take_all(const MacAddress& neighbor) {
  Hop* known = hops_.find(neighbor);
  return known == nullptr ? std::vector<HopFrame>{} : known->sender.take_all();
}

void Hops::maintain(Time now) {
  const auto is_gone = [this](const MacAddress& neighbor) { return neighbors_.find(neighbor) == nullptr; };
  hops_.erase_if([&](const MacAddress& neighbor, const Hop&) { return is_gone(neighbor); });
  turns_.forget_if(is_gone);
  for (const auto& [neighbor, hop] : hops_.all()) neighbors_.set_loss(neighbor, hop.sender.loss(now));
}

// --- what goes on the air --------------------------------------------------------------------------------------------

bool Hops::repeat_lost(std::uint8_t priority, const MacAddress& previous_hop, Time now) {
  return visit_after(hops_.busy(), last_served_, [&](const auto& item) {
    Hop& hop = *item.second;
    if (!hop.sender.has_resend(priority, previous_hop) || !hop.sender.may_resend() ||
        !air_allows(item.first, hop, priority, now)) {
      return false;
    }
    last_served_ = item.first;
    const std::uint64_t counter = transmitter_.take_counter();
    put_on_air(item.first, hop, hop.sender.resend(priority, previous_hop, counter, now), counter, now);
    return true;
  });
}

bool Hops::send_waiting(std::uint8_t priority, const MacAddress& previous_hop, Time now) {
  return visit_after(hops_.busy(), last_served_, [&](const auto& item) {
    Hop& hop = *item.second;
    if (!hop.sender.has_waiting(priority, previous_hop) || !hop.sender.may_start() ||
        !air_allows(item.first, hop, priority, now)) {
      return false;
    }
    last_served_ = item.first;
    start(item.first, hop, hop.sender.take_waiting(priority, previous_hop), now);
    return true;
  });
}

bool Hops::may_start(const MacAddress& neighbor, std::uint8_t priority, Time now) {
  const Hop& next = hop(neighbor);
  return next.sender.may_start() && air_allows(neighbor, next, priority, now);
}

void Hops::start(const MacAddress& neighbor, HopFrame frame, Time now) {
  start(neighbor, hop(neighbor), std::move(frame), now);
}

/// With the repetition on each hop switched off, frames carry no link sequence and nobody acknowledges them.
void Hops::start(const MacAddress& neighbor, Hop& hop, HopFrame frame, Time now) {
  if (options_.num_link_retrans == 0) {
    if (frame.type == FrameType::kData) {
      count(statistics_.unicast_data, frame.previous_hop != MacAddress{}, frame.again);
    }
    return transmitter_.transmit(frame.type, neighbor, {0, 0, transmitter_.take_counter(), frame.priority}, frame.body,
                                 now);
  }
  const std::uint64_t counter = transmitter_.take_counter();
  put_on_air(neighbor, hop, hop.sender.start(std::move(frame), counter, now), counter, now);
}

/// Frames that measure the air, the one that fills the window, and those that hardly ever are followed by others: what
/// they are part of waits for each.
bool Hops::wants_answer(const MacAddress& neighbor, Hop& hop, FrameType type, Time now) {
  const bool calibrated = air_.calibrated(neighbor);
  hop.pair = (hop.pair + 1) % air_.pair_interval(neighbor);
  const bool single = type != FrameType::kData && type != FrameType::kTransportAcknowledgment;
  return !calibrated || hop.sender.pressing() || hop.pair == 1 || (single && air_.alone(now)) ||
         air_.asks_for_delay(neighbor, now);
}

/// Turns that come back are taken where frames are as good as never lost: towards who is seen to hold its answers; a
/// relay gives what it holds an answer for to the destination, which answers at once, in turns as well.
bool Hops::needs_turn(const Hop& hop, const HopSender::Outgoing& outgoing) {
  if (outgoing.type != FrameType::kData || !takes_turns(outgoing.route, outgoing.priority)) return false;
  if (!TurnTaking::comes_back(outgoing.route)) return true;
  return hop.sender.reliable() && (outgoing.beyond > 0 ? hop.held_answers.usual() : outgoing.passed_on);
}

/// Whether the neighbour holds its answers shows only when no other frame overtakes the one that asks.
bool Hops::tries_turn(const Hop& hop, const HopSender::Outgoing& outgoing) {
  return hop.pair == 1 && outgoing.type == FrameType::kData && !is_urgent(outgoing.priority) && outgoing.beyond > 0 &&
         TurnTaking::comes_back(outgoing.route) && hop.sender.reliable();
}

bool Hops::ends_turn(const MacAddress& neighbor, const HopSender::Outgoing& outgoing, std::uint64_t counter, bool more,
                     Time now) {
  return turns_.sent(
      neighbor,
      {counter, more, outgoing.beyond, air_.undisturbed_frame_time(neighbor), TurnTaking::comes_back(outgoing.route)},
      now);
}

void Hops::put_on_air(const MacAddress& neighbor, Hop& hop, const HopSender::Outgoing& outgoing, std::uint64_t counter,
                      Time now) {
  const bool shared = air_.shared(now);
  hop.sender.be_patient(shared ? turns_.patience(neighbor) : Time(0));
  hop.sender.be_eager(air_.alone(now));
  hop.sender.expect(delays(neighbor));
  hop.sender.be_sparing(neighbors_.radio_may_repeat());
  hop.sender.expect_jitter(air_.jittered(neighbor));
  const bool in_turn = shared && needs_turn(hop, outgoing);
  const auto more = [&] { return hop.sender.may_start() && (outgoing.more || hop.sender.has_more()); };
  const bool at_once =
      in_turn ? ends_turn(neighbor, outgoing, counter, more(), now) : wants_answer(neighbor, hop, outgoing.type, now);
  if (shared && !in_turn && tries_turn(hop, outgoing)) ends_turn(neighbor, outgoing, counter, false, now);
  if (at_once) hop.sender.ask(counter, now);
  const auto flags = static_cast<std::uint8_t>(wire::kWantsAcknowledgment | (at_once ? wire::kAcknowledgeNow : 0));
  if (outgoing.type == FrameType::kData) count(statistics_.unicast_data, outgoing.passed_on, outgoing.again);
  transmitter_.transmit(outgoing.type, neighbor, {flags, outgoing.link_sequence, counter, outgoing.priority},
                        *outgoing.body, now);
}

bool Hops::is_turn(const MacAddress& neighbor, std::uint8_t priority, Time now) const {
  return is_urgent(priority) || !air_.shared(now) || turns_.opens(neighbor) <= now;
}

/// Two frames may be on their way to each neighbour even if the air is believed to be slow, as long as that is not for
/// long. Of a pair that measures the air, the first waits until the radio is idle and the second follows at once, so
/// that no more is in its hands than otherwise.
bool Hops::air_allows(const MacAddress& neighbor, const Hop& hop, std::uint8_t priority, Time now) const {
  if (!is_turn(neighbor, priority, now)) return false;
  if (!is_urgent(priority) && air_.shared(now) && turns_.goes_on(neighbor)) {
    return air_.ready_at() <= now + kLongestBacklog;
  }
  const bool pair_begins = air_.calibrated(neighbor) && hop.pair == air_.pair_interval(neighbor) - 1;
  const bool keeps_busy = air_.varies() && !air_.jittered(neighbor) && hop.sender.hardly_loses();
  if (pair_begins && !keeps_busy && air_.idle_at() > now && air_.idle_at() <= now + kLongestBacklog) return false;
  if (air_.ready_at() <= now) return true;
  if (options_.num_link_retrans == 0) return false;
  return hop.pair == 0 || (hop.sender.unresolved() < 2 && air_.ready_at() <= now + kLongestBacklog);
}

void Hops::add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const {
  for (const auto& [neighbor, hop] : hops_.busy()) hop->sender.add_waiting_hops(priority, hops);
}

bool Hops::something_to_send(Time now) const {
  return std::any_of(hops_.busy().begin(), hops_.busy().end(), [&](const auto& item) {
    const HopSender& sender = item.second->sender;
    for (std::uint8_t priority = 0; priority < kPriorities; ++priority) {
      if (!is_turn(item.first, priority, now)) continue;
      if (sender.has_resend(priority) && sender.may_resend()) return true;
      if (sender.has_waiting(priority) && sender.may_start()) return true;
    }
    return false;
  });
}

// --- what others may look at -----------------------------------------------------------------------------------------

bool Hops::has_room(const MacAddress& neighbor, std::uint8_t priority, Time now) const {
  const Hop* known = hops_.find(neighbor);
  return is_turn(neighbor, priority, now) && (known == nullptr || known->sender.may_start());
}

bool Hops::idle(const MacAddress& neighbor) const {
  const Hop* known = hops_.find(neighbor);
  return known == nullptr || known->sender.idle();
}

const HopSender* Hops::sender_to(const MacAddress& neighbor) const {
  const Hop* known = hops_.find(neighbor);
  return known == nullptr ? nullptr : &known->sender;
}

}  // namespace adhoc_communication::transport
