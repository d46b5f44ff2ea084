#include "medium/medium.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

constexpr Time kLongestReordering = std::chrono::milliseconds(5);
constexpr double kFarthest = 1e9;  // metres
constexpr std::size_t kMostSlots = 1024;

}  // namespace

Medium::Medium(const MediumOptions& options, std::uint64_t seed)
    : random_(seed), reach_(validated(options), seed), bursts_(options.bursts, seed) {}

Medium::Node Medium::add_node(const std::string& name, std::optional<MacAddress> address) {
  NodeState node;
  node.name = name;
  node.address = address;
  if (address) by_address_[*address] = nodes_.size();
  nodes_.push_back(std::move(node));
  reach_.add_node();
  turns_.add_node();
  return nodes_.size() - 1;
}

std::optional<Medium::Node> Medium::find(const std::string& name) const {
  for (Node node = 0; node < nodes_.size(); ++node) {
    if (nodes_[node].name == name) return node;
  }
  return std::nullopt;
}

void Medium::set_position(Node node, double x, double y) {
  if (!(std::abs(x) <= kFarthest && std::abs(y) <= kFarthest)) {
    throw std::invalid_argument("the position of " + name(node) + " is not within 1e9 m of the origin");
  }
  reach_.set_position(node, {x, y});
}

void Medium::set_bit_rate(double bit_rate) {
  if (!(bit_rate > 0.0)) throw std::invalid_argument("the bit rate of the medium is not above zero");
  reach_.set_bit_rate(bit_rate);
}

void Medium::set_link_loss(Node a, Node b, std::optional<double> probability) {
  set_one_way_loss(a, b, probability);
  set_one_way_loss(b, a, probability);
}

void Medium::set_one_way_loss(Node from, Node to, std::optional<double> probability) {
  reach_.set_link_loss(from, to, probability);
}

void Medium::set_up(Node node, bool up, Time now) {
  NodeState& state = nodes_.at(node);
  if (state.up && !up) {
    ++state.life;
    state.queued = 0;
    state.busy_until = now;
    state.waiting.clear();
    if (state.attempt) attempts_.erase({*state.attempt, node});
    state.attempt.reset();
    state.retries = 0;
    channel_.silence(node, now);
  }
  state.up = up;
}

void Medium::transmit(Node node, Frame sent, Time now) {
  NodeState& state = nodes_.at(node);
  SharedFrame frame = std::make_shared<const Frame>(std::move(sent));
  if (state.address != frame->source) {
    const auto former = state.address ? by_address_.find(*state.address) : by_address_.end();
    if (former != by_address_.end() && former->second == node) by_address_.erase(former);
    state.address = frame->source;
    by_address_[frame->source] = node;
  }
  if (!state.up || state.queued >= options().queue_limit) return count(node, &Counters::discarded);
  ++state.queued;
  if (options().contention) {
    const bool is_idle = state.queued == 1;
    state.waiting.push_back(std::move(frame));
    if (is_idle) back_off(node, now);
    return;
  }
  if (options().spatial_reuse) return take_turn(node, std::move(frame), now);
  Time& busy_until = options().shared ? shared_busy_until_ : state.busy_until;
  const Time begin = std::max(busy_until, now);
  const Time duration = air_time(node, *frame);
  busy_until = begin + duration;
  launch(node, std::move(frame), begin, duration);
}

void Medium::take_turn(Node node, SharedFrame frame, Time now) {
  std::vector<Turns::Listener> listeners;
  for (const Hearer& hearer : reach_.hearers(node)) {
    listeners.push_back({hearer.node, addressed(*frame, nodes_[hearer.node])});
  }
  const Time begin = turns_.next(node, listeners, now);
  const Time duration = air_time(node, *frame);
  turns_.take(node, listeners, begin + duration);
  launch(node, std::move(frame), begin, duration);
}

Time Medium::air_time(Node sender, const Frame& frame) {
  const double octets = static_cast<double>(frame.bytes.size());
  const Time answer = is_repeated(frame) ? options().rates.acknowledgment : Time(0);
  return Time(static_cast<Time::rep>(8e9 * octets / bit_rate(sender, frame))) + options().frame_overhead + answer;
}

double Medium::bit_rate(Node sender, const Frame& frame) {
  const RateOptions& rates = options().rates;
  if (frame.destination == wire::kEverybody) return rates.broadcast > 0.0 ? rates.broadcast : options().bit_rate;
  if (rates.unicast.empty()) return options().bit_rate;
  const auto receiver = by_address_.find(frame.destination);
  const Hearer* hearer = receiver == by_address_.end() ? nullptr : reach_.hearer(sender, receiver->second);
  return unicast_bit_rate(
      rates.unicast, hearer == nullptr ? std::optional<double>() : std::optional(hearer->power - reach_.threshold()));
}

/// By the link layer, until its receiver has got it.
bool Medium::is_repeated(const Frame& frame) const {
  return options().rates.unicast_retries > 0 && frame.destination != wire::kEverybody;
}

Medium::FlightKey Medium::launch(Node sender, SharedFrame frame, Time begin, Time duration) {
  NodeState& state = nodes_[sender];
  for (Counters* counters : {&state.counters, &counters_}) {
    ++counters->frames;
    counters->octets += frame->bytes.size();
    counters->air_time += duration;
  }
  const FlightKey key(begin + duration, next_flight_++);
  flights_.emplace(key, Flight{sender, state.life, std::move(frame), begin, begin + duration, true, {}});
  return key;
}

void Medium::back_off(Node node, Time idle_from) {
  const std::size_t window = options().slots << std::min(nodes_[node].retries, 16);
  const std::size_t most = std::max(options().slots, kMostSlots);
  const auto slots = static_cast<Time::rep>(random_.next() % std::min(window, most));
  nodes_[node].attempt = idle_from + slots * options().slot;
  attempts_.emplace(*nodes_[node].attempt, node);
}

void Medium::attempt(Node node, Time at) {
  NodeState& state = nodes_[node];
  attempts_.erase({at, node});
  state.attempt.reset();
  const Time idle_from = channel_.sensed_until(node, at, reach_);
  if (idle_from > at) return back_off(node, idle_from);
  const SharedFrame frame = std::move(state.waiting.front());
  state.waiting.pop_front();
  const FlightKey key = launch(node, frame, at, air_time(node, *frame));
  channel_.begin(key.second, node, at, key.first, reach_);
}

std::optional<Time> Medium::next_delivery() const {
  std::optional<Time> next;
  if (!flights_.empty()) next = flights_.begin()->first.first;
  if (!attempts_.empty()) next = std::min(next.value_or(Time::max()), attempts_.begin()->first);
  if (!delayed_.empty()) next = std::min(next.value_or(Time::max()), delayed_.begin()->first);
  return next;
}

std::vector<Medium::Delivery> Medium::deliveries(Time now) {
  std::vector<Delivery> out;
  for (auto next = next_delivery(); next && *next <= now; next = next_delivery()) {
    const bool is_landing = !flights_.empty() && flights_.begin()->first.first == *next;
    if (!delayed_.empty() && delayed_.begin()->first == *next) {
      take_delayed(out);
    } else if (is_landing) {
      land(*next, out);
    } else {
      attempt(attempts_.begin()->second, *next);
    }
  }
  return out;
}

void Medium::land(Time at, std::vector<Delivery>& out) {
  const std::uint64_t id = flights_.begin()->first.second;
  Flight flight = std::move(flights_.begin()->second);
  flights_.erase(flights_.begin());
  if (options().contention && flight.first) flight.overlapping = channel_.end(id);
  if (flight.life == nodes_[flight.sender].life) arrive(flight, at, out);
}

void Medium::arrive(Flight& flight, Time at, std::vector<Delivery>& out) {
  const bool answered = flight.first && is_repeated(*flight.frame);
  if (flight.first && !answered) go_on(flight.sender, at);
  const bool delayed = flight.first && repeat_or_delay(flight, at);
  const bool lost = !delayed && !deliver(flight, at, out);
  if (!answered || (lost && try_again(flight, at))) return;
  go_on(flight.sender, at);
}

/// With the next frame.
void Medium::go_on(Node sender, Time at) {
  NodeState& state = nodes_[sender];
  --state.queued;
  state.retries = 0;
  if (!state.waiting.empty()) back_off(sender, at);
}

bool Medium::try_again(const Flight& flight, Time at) {
  NodeState& state = nodes_[flight.sender];
  if (state.retries >= options().rates.unicast_retries) return false;
  ++state.retries;
  count(flight.sender, &Counters::repeated);
  state.waiting.push_front(flight.frame);
  back_off(flight.sender, at);
  return true;
}

bool Medium::deliver(const Flight& flight, Time at, std::vector<Delivery>& out) {
  bool arrived = false;
  for (const Hearer& hearer : reach_.hearers(flight.sender)) {
    const NodeState& receiver = nodes_[hearer.node];
    if (!receiver.up || !addressed(*flight.frame, receiver) || !survives(flight, hearer)) continue;
    if (lost(flight, hearer, at)) {
      count(flight.sender, &Counters::lost);
      continue;
    }
    count(flight.sender, &Counters::delivered);
    arrived |= receiver.address == flight.frame->destination;
    const bool corrupt = options().corruption > 0 && random_.chance(options().corruption);
    hand_over({hearer.node, corrupt ? corrupted(*flight.frame) : flight.frame}, at, out);
  }
  return arrived;
}

bool Medium::lost(const Flight& flight, const Hearer& receiver, Time at) {
  if (receiver.loss > 0.0 && random_.chance(receiver.loss)) return true;
  if (interferes(options().interference, flight.begin, flight.end)) return true;
  return bursts_.bad(flight.sender, receiver.node, at) && random_.chance(bursts_.loss());
}

void Medium::hand_over(Delivery delivery, Time at, std::vector<Delivery>& out) {
  const DelayOptions& delay = options().delay;
  if (delay.fixed + delay.jitter == Time(0)) return out.push_back(std::move(delivery));
  NodeState& receiver = nodes_[delivery.node];
  Time arrival = at + delay.fixed + (delay.jitter > Time(0) ? random_.delay(delay.jitter) : Time(0));
  if (!delay.reorders) arrival = receiver.latest = std::max(arrival, receiver.latest);
  delayed_.emplace(arrival, Delayed{receiver.life, std::move(delivery)});
}

void Medium::take_delayed(std::vector<Delivery>& out) {
  Delayed next = std::move(delayed_.begin()->second);
  delayed_.erase(delayed_.begin());
  const NodeState& receiver = nodes_[next.delivery.node];
  if (receiver.up && receiver.life == next.life) out.push_back(std::move(next.delivery));
}

bool Medium::repeat_or_delay(const Flight& flight, Time at) {
  const auto again = [&](Time delay) {
    const FlightKey key(at + delay, next_flight_++);
    flights_.emplace(
        key, Flight{flight.sender, flight.life, flight.frame, flight.begin, flight.end, false, flight.overlapping});
  };
  if (options().duplication > 0 && random_.chance(options().duplication)) again(random_.delay(kLongestReordering));
  if (options().reordering <= 0 || !random_.chance(options().reordering)) return false;
  again(random_.delay(kLongestReordering));
  return true;
}

bool Medium::survives(const Flight& flight, const Hearer& receiver) {
  for (const Node other : flight.overlapping) {
    if (other == receiver.node) {
      count(flight.sender, &Counters::unheard);
      return false;
    }
    const Hearer* disturbed = reach_.hearer(other, receiver.node);
    if (disturbed == nullptr || receiver.power - disturbed->power >= options().capture) continue;
    count(flight.sender, &Counters::collided);
    return false;
  }
  return true;
}

void Medium::count(Node sender, std::uint64_t Counters::*counter) {
  ++(counters_.*counter);
  ++(nodes_[sender].counters.*counter);
}

bool Medium::addressed(const Frame& frame, const NodeState& node) const {
  return frame.destination == wire::kEverybody || !node.address || *node.address == frame.destination;
}

Medium::SharedFrame Medium::corrupted(Frame frame) {
  Bytes& bytes = frame.bytes;
  if (!bytes.empty()) bytes[random_.next() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random_.next() % 255);
  return std::make_shared<const Frame>(std::move(frame));
}

}  // namespace adhoc_communication
