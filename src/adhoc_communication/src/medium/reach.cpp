#include "medium/reach.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace adhoc_communication {
namespace {

constexpr double kMargin = 1.001;  // for rounding

double weakest_power(const MediumOptions& options) {
  return options.path_loss ? options.path_loss->p_thres : received_power(PathLoss(), options.range);
}

auto place_of(std::vector<Hearer>& hearers, std::size_t node) {
  return std::lower_bound(hearers.begin(), hearers.end(), node,
                          [](const Hearer& hearer, std::size_t number) { return hearer.node < number; });
}

}  // namespace

Reach::Reach(const MediumOptions& options, std::uint64_t seed)
    : options_(options),
      path_loss_(options.path_loss.value_or(PathLoss())),
      shadowing_(options.shadowing, seed),
      grid_(options.range) {
  make_grid();
}

void Reach::add_node() {
  unplaced_.push_back(places_.size());
  places_.emplace_back();
  ++version_;
}

void Reach::set_position(Node node, const Position& position) {
  Place& place = places_.at(node);
  if (place.position == position) return;
  if (place.position) {
    grid_.remove(node, *place.position);
  } else {
    unplaced_.erase(std::find(unplaced_.begin(), unplaced_.end(), node));
  }
  grid_.insert(node, position);
  place.position = position;
  place.shadowing = shadowing_.at(position);
  ++version_;
}

void Reach::set_range(double metres) {
  options_.range = metres;
  make_grid();
}

void Reach::set_loss(double probability) {
  options_.loss = probability;
  ++version_;
}

void Reach::set_link_loss(Node from, Node to, std::optional<double> probability) {
  if (probability) {
    link_loss_[{from, to}] = *probability;
  } else {
    link_loss_.erase({from, to});
  }
  ++version_;
}

void Reach::make_grid() {
  threshold_ = weakest_power(options_);
  farthest_ = farthest();
  grid_ = NeighborGrid(farthest_);
  for (Node node = 0; node < places_.size(); ++node) {
    if (places_[node].position) grid_.insert(node, *places_[node].position);
  }
  ++version_;
}

bool Reach::is_plain() const { return !options_.path_loss && !shadowing_.exists() && options_.walls.cells.empty(); }

double Reach::farthest() const {
  if (is_plain()) return options_.range;
  return kMargin * distance_of_power(path_loss_, threshold_ - shadowing_.best());
}

double Reach::power_between(const Place& a, const Place& b) const {
  if (!a.position || !b.position) return received_power(path_loss_, 0.0);
  return power_at(distance_between(*a.position, *b.position), a, b);
}

double Reach::power_at(double distance, const Place& a, const Place& b) const {
  const double power = received_power(path_loss_, distance) - shadowing_.between(a.shadowing, b.shadowing);
  if (power < threshold_ || options_.walls.cells.empty()) return power;  // walls only make it weaker
  return power - options_.wall_attenuation * walls_between(options_.walls, *a.position, *b.position);
}

std::optional<double> Reach::power_if_in_range(const Place& a, const Place& b) const {
  if (!a.position || !b.position) return received_power(path_loss_, 0.0);
  const double distance = distance_between(*a.position, *b.position);
  if (distance > farthest_) return std::nullopt;
  const double power = power_at(distance, a, b);
  if (!is_plain() && power < threshold_) return std::nullopt;
  return power;
}

bool Reach::in_range(Node a, Node b) const { return power_if_in_range(places_.at(a), places_.at(b)).has_value(); }

bool Reach::may_meet(Node a, Node b) const {
  const auto& here = places_.at(a).position;
  const auto& there = places_.at(b).position;
  return !here || !there || !link_loss_.empty() || distance_between(*here, *there) <= 2.0 * kMargin * farthest_;
}

const std::vector<Hearer>& Reach::hearers(Node sender) {
  Place& place = places_.at(sender);
  if (place.version != version_) {
    place.hearers.clear();
    find_hearers(sender, place.hearers);
    place.version = version_;
  }
  return place.hearers;
}

const Hearer* Reach::hearer(Node sender, Node receiver) {
  hearers(sender);
  const auto found = place_of(places_[sender].hearers, receiver);
  return found == places_[sender].hearers.end() || found->node != receiver ? nullptr : &*found;
}

void Reach::find_hearers(Node sender, std::vector<Hearer>& hearers) {
  const Place& here = places_[sender];
  candidates_ = unplaced_;
  if (here.position) {
    grid_.near(*here.position, candidates_);
  } else {
    candidates_.resize(places_.size());
    std::iota(candidates_.begin(), candidates_.end(), 0);
  }
  for (const Node node : candidates_) {
    if (node == sender || options_.loss >= 1.0) continue;
    if (const auto power = power_if_in_range(here, places_[node])) hearers.push_back({node, options_.loss, *power});
  }
  std::sort(hearers.begin(), hearers.end(), [](const Hearer& a, const Hearer& b) { return a.node < b.node; });
  apply_link_losses(sender, hearers);
}

void Reach::apply_link_losses(Node sender, std::vector<Hearer>& hearers) const {
  for (auto link = link_loss_.lower_bound({sender, 0}); link != link_loss_.end() && link->first.first == sender;
       ++link) {
    const auto& [node, loss] = std::pair(link->first.second, link->second);
    if (node == sender) continue;
    const auto place = place_of(hearers, node);
    const bool is_hearer = place != hearers.end() && place->node == node;
    if (loss >= 1.0) {
      if (is_hearer) hearers.erase(place);
    } else if (is_hearer) {
      place->loss = loss;
    } else {
      hearers.insert(place, {node, loss, power_between(places_[sender], places_[node])});
    }
  }
}

}  // namespace adhoc_communication
