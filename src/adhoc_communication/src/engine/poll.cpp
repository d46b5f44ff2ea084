// What is due now, and when something is due next.
#include <algorithm>

#include "engine/implementation.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr Time kTolerableLateness = std::chrono::milliseconds(20);

}  // namespace

std::vector<Frame> Engine::Implementation::poll(Time now) {
  now_ = now;
  touched_ = false;
  streams_.take_news();
  if (now - kTolerableLateness > next_poll_) hops_.excuse_silence(now);
  if (rhythm_.due() <= now) {
    maintain(now);
    presence_.send_beacon(now);
  }
  announce_changes(now);
  outgoing_.expire(now);
  for (const MacAddress& neighbor : hops_.expire(now)) {
    links_.lost(neighbor, now);
    presence_.ask_in_doubt(neighbor, now);
  }
  for (const transport::Undelivered& packet : streams_.serve(now))
    outgoing_.finish(packet.id, false, packet.reason, now);
  receivers_.acknowledge(now);
  router_.poll(now);
  fail_unreachable(now);
  forwarder_.release(now);
  distributor_.poll(now);
  groups_.take_member_ends();
  outgoing_.settle(now);
  incoming_.take_group_packets(now);
  flood_.poll(now);
  outgoing_.settle_floods();
  hops_.acknowledge(now);
  for (const SendId id : schedule_.pump(now)) outgoing_.finish(id, true, {}, now);
  hops_.settle();
  receivers_.settle();
  next_poll_ = next_due();
  return transmitter_.take_frames();
}

Time Engine::Implementation::next_due() const {
  if (touched_ || streams_.has_news()) return now_;
  return std::min({rhythm_.due(), router_.next_deadline(), flood_.next_deadline(), distributor_.next_deadline(),
                   outgoing_.next_deadline(), hops_.next_deadline(now_), receivers_.next_deadline(),
                   streams_.next_deadline(), schedule_.next_deadline(now_)});
}

/// What has to be looked at a few times a second; rides on the beacons, so that an idle engine has one timer.
void Engine::Implementation::maintain(Time now) {
  for (const MacAddress& neighbor : neighbors_.newly_silent(now)) links_.lost(neighbor, now);
  for (const MacAddress& neighbor : neighbors_.remove_silent(routing::RobotDirectory::kSilence, now)) {
    links_.lost(neighbor, now);
    hops_.forget(neighbor);
  }
  hops_.maintain(now);
  air_.forget_unless([this](const MacAddress& neighbor) { return neighbors_.find(neighbor) != nullptr; });
  presence_.probe_doubtful(now);
  directory_.expire(now);
  runs_.expire(now);
  router_.expire(now);
  broadcast_receiver_.expire(now);
  receivers_.expire(now);
  distributor_.expire(now);
  groups_.expire(now);
  outgoing_.settle(now);
}

void Engine::Implementation::announce_changes(Time now) {
  for (const std::string& name : directory_.take_taken_names()) events_.add(NameTaken{name});
  for (const routing::DirectoryChange& change : directory_.take_changes()) {
    rhythm_.happened(now);
    if (change.appeared) {
      events_.add(RobotAppeared{change.robot});
      groups_.appeared(change.robot, change.boot, now);
    } else {
      events_.add(RobotLost{change.robot});
      groups_.lost(change.robot, change.boot, now);
    }
    outgoing_.settle(now);
  }
}

void Engine::Implementation::fail_unreachable(Time now) {
  for (const routing::DiscoveryFailure& failure : router_.take_failures(now)) {
    if (failure.repair) {
      distributor_.unreachable(failure.target.address, {}, true, now);
      streams_.repair_failed(failure.target.address);
      touched_ = true;
      continue;
    }
    receivers_.forgo(failure.target.address);
    std::string name = failure.target.name;
    if (const routing::Robot* robot = directory_.find(failure.target.address)) name = robot->name;
    const std::string reason = failure.elapsed > Time(0)
                                   ? "no route to " + name + " after " + seconds_text(failure.elapsed)
                                   : "no route to " + name + ": too many searches at once";
    distributor_.unreachable(failure.target.address, reason, false, now);
    for (const SendId id : streams_.abandon(name, now)) outgoing_.finish(id, false, reason, now);
  }
}

std::vector<Record> Engine::Implementation::take_records() {
  statistics_.records_lost = journal_.lost();
  return journal_.take();
}

}  // namespace adhoc_communication
