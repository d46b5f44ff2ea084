#include "node/channel_model.hpp"

#include <utility>

#include "link/mac_address.hpp"
#include "propagation/path_loss.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMaxUnnamedSenders = 64;

}  // namespace

bool is_received(const ChannelModel& model, double distance) {
  PathLoss path_loss;
  path_loss.p_tx = model.p_tx;
  path_loss.p_thres = model.p_thres;
  path_loss.l_0_model = model.l_0_model;
  path_loss.n_model = model.n_model;
  return received_power(path_loss, distance) >= path_loss.p_thres;
}

void PositionTable::set(const std::string& robot, Position position) {
  const std::lock_guard<std::mutex> lock(mutex_);
  positions_[robot] = position;
}

std::optional<Position> PositionTable::get(const std::string& robot) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = positions_.find(robot);
  if (found == positions_.end()) return std::nullopt;
  return found->second;
}

ReceiveFilter::ReceiveFilter(std::string own_name, std::map<MacAddress, std::string> names, ChannelModel model,
                             const PositionTable* positions)
    : own_name_(std::move(own_name)), names_(std::move(names)), model_(model), positions_(positions) {}

std::optional<std::string> ReceiveFilter::name_of(const MacAddress& address) const {
  const auto found = names_.find(address);
  return found == names_.end() ? robot_of_address(address) : found->second;
}

bool ReceiveFilter::accepts(const Frame& frame) {
  if (!names_.empty() && names_.count(frame.source) == 0) return false;
  if (positions_ == nullptr) return true;
  const auto sender = name_of(frame.source);
  if (!sender) {
    if (unnamed_senders_.size() < kMaxUnnamedSenders && unnamed_senders_.insert(frame.source).second) {
      unreported_sender_ = frame.source;
    }
    return false;
  }
  const auto here = positions_->get(own_name_);
  const auto there = positions_->get(*sender);
  return here && there && is_received(model_, distance_between(*here, *there));
}

std::optional<MacAddress> ReceiveFilter::next_unnamed_sender() {
  return std::exchange(unreported_sender_, std::nullopt);
}

}  // namespace adhoc_communication
