#include "link/medium.hpp"

#include <algorithm>
#include <cmath>

#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

constexpr Time kLongestReordering = std::chrono::milliseconds(5);

}  // namespace

Medium::Medium(const MediumOptions& options, std::uint64_t seed) : options_(options), random_(seed) {}

Medium::Node Medium::add_node(const std::string& name, std::optional<MacAddress> address) {
  NodeState node;
  node.name = name;
  node.address = address;
  nodes_.push_back(std::move(node));
  return nodes_.size() - 1;
}

std::optional<Medium::Node> Medium::find(const std::string& name) const {
  for (Node node = 0; node < nodes_.size(); ++node) {
    if (nodes_[node].name == name) return node;
  }
  return std::nullopt;
}

void Medium::set_position(Node node, double x, double y) { nodes_.at(node).position = std::pair(x, y); }

void Medium::set_link_loss(Node a, Node b, std::optional<double> probability) {
  set_one_way_loss(a, b, probability);
  set_one_way_loss(b, a, probability);
}

void Medium::set_one_way_loss(Node from, Node to, std::optional<double> probability) {
  if (probability) {
    link_loss_[{from, to}] = *probability;
  } else {
    link_loss_.erase({from, to});
  }
}

void Medium::set_up(Node node, bool up, Time now) {
  NodeState& state = nodes_.at(node);
  if (state.up && !up) {
    ++state.life;
    state.queued = 0;
    state.busy_until = now;
  }
  state.up = up;
}

void Medium::transmit(Node node, const Frame& frame, Time now) {
  NodeState& state = nodes_.at(node);
  state.address = frame.source;
  if (!state.up || state.queued >= options_.queue_limit) {
    ++state.counters.discarded;
    ++counters_.discarded;
    return;
  }
  const Time octets_time(static_cast<Time::rep>(8e9 * static_cast<double>(frame.bytes.size()) / options_.bit_rate));
  const Time air_time = octets_time + options_.frame_overhead;
  Time& busy_until = options_.shared ? shared_busy_until_ : state.busy_until;
  busy_until = std::max(busy_until, now) + air_time;
  state.busy_until = busy_until;
  ++state.queued;
  for (Counters* counters : {&state.counters, &counters_}) {
    ++counters->frames;
    counters->octets += frame.bytes.size();
    counters->air_time += air_time;
  }
  flights_.emplace(std::pair(busy_until, next_flight_++), Flight{node, state.life, frame});
}

std::optional<Time> Medium::next_delivery() const {
  if (flights_.empty()) return std::nullopt;
  return flights_.begin()->first.first;
}

std::vector<Medium::Delivery> Medium::deliveries(Time now) {
  std::vector<Delivery> out;
  while (!flights_.empty() && flights_.begin()->first.first <= now) {
    const Time at = flights_.begin()->first.first;
    const Flight flight = std::move(flights_.begin()->second);
    flights_.erase(flights_.begin());
    arrive(flight, at, out);
  }
  return out;
}

void Medium::arrive(const Flight& flight, Time at, std::vector<Delivery>& out) {
  NodeState& sender = nodes_[flight.sender];
  if (flight.life != sender.life) return;
  if (flight.first) {
    --sender.queued;
    const auto again = [&](Time delay) {
      flights_.emplace(std::pair(at + delay, next_flight_++), Flight{flight.sender, flight.life, flight.frame, false});
    };
    if (options_.duplication > 0 && random_.chance(options_.duplication)) {
      again(random_.delay(kLongestReordering));
    }
    if (options_.reordering > 0 && random_.chance(options_.reordering)) {
      again(random_.delay(kLongestReordering));
      return;
    }
  }
  for (Node node = 0; node < nodes_.size(); ++node) {
    if (node == flight.sender || !nodes_[node].up || !addressed(flight.frame, nodes_[node])) continue;
    const double loss = loss_between(flight.sender, node);
    if (loss >= 1.0) continue;
    if (loss > 0.0 && random_.chance(loss)) {
      ++counters_.lost;
      ++sender.counters.lost;
      continue;
    }
    ++counters_.delivered;
    ++sender.counters.delivered;
    out.push_back({node, flight.frame});
    if (options_.corruption > 0 && random_.chance(options_.corruption)) corrupt(out.back().frame.bytes);
  }
}

Time Medium::free_at(Node node) const { return options_.shared ? shared_busy_until_ : nodes_.at(node).busy_until; }

bool Medium::in_range(Node a, Node b) const {
  const auto& p = nodes_.at(a).position;
  const auto& q = nodes_.at(b).position;
  return !p || !q || std::hypot(p->first - q->first, p->second - q->second) <= options_.range;
}

double Medium::loss_between(Node from, Node to) const {
  const auto link = link_loss_.find({from, to});
  if (link != link_loss_.end()) return link->second;
  return in_range(from, to) ? options_.loss : 1.0;
}

bool Medium::addressed(const Frame& frame, const NodeState& node) const {
  return frame.destination == wire::kEverybody || !node.address || *node.address == frame.destination;
}

void Medium::corrupt(Bytes& bytes) {
  if (bytes.empty()) return;
  bytes[random_.next() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random_.next() % 255);
}

}  // namespace adhoc_communication
