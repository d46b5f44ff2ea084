#include "adhoc_communication/engine.hpp"

#include "engine/implementation.hpp"

namespace adhoc_communication {

Engine::Engine(EngineOptions options, MacAddress address, BootId boot_id, std::uint64_t seed, Time now)
    : implementation_(std::make_unique<Implementation>(std::move(options), address, boot_id, seed, now)) {}

Engine::~Engine() = default;

void Engine::receive(const Frame& frame, Time now) { implementation_->receive(frame, now); }
SendId Engine::send(SendRequest request, Time now) { return implementation_->send(std::move(request), now); }
SendId Engine::broadcast(BroadcastRequest request, Time now) {
  return implementation_->broadcast(std::move(request), now);
}
std::vector<Frame> Engine::poll(Time now) { return implementation_->poll(now); }
void Engine::handed_over(bool kept) { implementation_->handed_over(kept); }
Time Engine::next_deadline() const { return implementation_->next_deadline(); }
std::optional<Event> Engine::next_event() { return implementation_->next_event(); }
std::vector<Record> Engine::take_records() { return implementation_->take_records(); }
void Engine::join_group(const std::string& group, Time now) { implementation_->join_group(group, now); }
void Engine::leave_group(const std::string& group, Time now) { implementation_->leave_group(group, now); }
GroupState Engine::group_state(const std::string& group) const {
  return implementation_->look().group(group, implementation_->now());
}
std::vector<std::string> Engine::neighbors() const { return implementation_->look().neighbors(); }
std::vector<std::string> Engine::robots() const { return implementation_->look().robots(); }
void Engine::restart(MacAddress address, int mtu, BootId boot_id, std::uint64_t seed, Time now) {
  EngineOptions options = implementation_->options();
  options.mtu = mtu;
  auto next = std::make_unique<Implementation>(std::move(options), address, boot_id, seed, now);
  next->succeed(*implementation_, now);
  implementation_ = std::move(next);
}
const Statistics& Engine::statistics() const { return implementation_->statistics(); }
const std::string& Engine::robot_name() const { return implementation_->robot_name(); }
void Engine::set_keys(std::vector<TeamKey> keys) { implementation_->set_keys(std::move(keys)); }
std::vector<TableFill> Engine::tables() const { return implementation_->look().tables(); }
std::vector<RouteState> Engine::routes() const { return implementation_->look().routes(); }
std::vector<LinkState> Engine::links() const { return implementation_->look().links(implementation_->now()); }
std::vector<TreeState> Engine::trees() const { return implementation_->look().trees(); }
QueueState Engine::queues() const { return implementation_->look().queues(); }
std::vector<std::string> Engine::groups() const { return implementation_->look().groups(); }
std::optional<std::string> Engine::name_of(const MacAddress& robot) const {
  return implementation_->look().name_of(robot);
}

}  // namespace adhoc_communication
