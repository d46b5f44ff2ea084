#include "node/diagnostics.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

namespace adhoc_communication {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kPoorLink = 0.5;                  // loss that is worth a warning
constexpr std::uint32_t kManyPackets = 192;        // of the 256 that may wait
constexpr std::uint64_t kManyOctets = 48'000'000;  // of the 64 MB that may wait

void add(DiagnosticStatus& status, const std::string& key, const std::string& value) {
  diagnostic_msgs::KeyValue pair;
  pair.key = key;
  pair.value = value;
  status.values.push_back(pair);
}

void add(DiagnosticStatus& status, const std::string& key, std::uint64_t value) {
  add(status, key, std::to_string(value));
}

/// The worst of all complaints is the level, the first one the message.
void complain(DiagnosticStatus& status, unsigned char level, const std::string& message) {
  if (status.level < level) {
    status.level = level;
    status.message = message;
  }
}

DiagnosticStatus healthy(const std::string& message) {
  DiagnosticStatus status;
  status.level = DiagnosticStatus::OK;
  status.message = message;
  return status;
}

/// Two others of one name complain of it themselves.
bool own_name_is_taken(const NetworkState& state) {
  return std::find(state.robots.begin(), state.robots.end(), state.robot_name) != state.robots.end();
}

std::string percent(double ratio) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100.0 * ratio);
  return text;
}

}  // namespace

diagnostic_msgs::DiagnosticArray Diagnostics::report(const NetworkState& state) {
  ++report_;
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = state.stamp;
  const std::string prefix = "adhoc_communication " + state.robot_name + ": ";
  const auto append = [&](const std::string& name, DiagnosticStatus status) {
    status.name = prefix + name;
    status.hardware_id = state.address;
    array.status.push_back(std::move(status));
  };
  append("interface", interface(state));
  append("security", security(state));
  append("neighbors", neighbors(state));
  append("queues", queues(state));
  append("dropped frames", dropped_frames(state));
  append("publishing", publishing(state));
  append("relays", relays(state));
  append("files", files(state));
  forget_unwatched();
  return array;
}

bool Diagnostics::grows(const std::string& name, std::uint64_t value) {
  Watched& watched = watched_[name];
  watched.reports_left = value > watched.value ? kReportsAfterLoss : std::max(watched.reports_left - 1, 0);
  watched.value = value;
  watched.report = report_;
  return watched.reports_left > 0;
}

/// Relays come and go.
void Diagnostics::forget_unwatched() {
  for (auto iterator = watched_.begin(); iterator != watched_.end();) {
    iterator = iterator->second.report == report_ ? std::next(iterator) : watched_.erase(iterator);
  }
}

DiagnosticStatus Diagnostics::interface(const NetworkState& state) {
  DiagnosticStatus status = healthy(state.interface + " is up");
  const bool refuses = grows("not sent", state.frames_not_sent);
  if (!state.interface_up) complain(status, DiagnosticStatus::ERROR, state.interface + " is down");
  if (refuses) complain(status, DiagnosticStatus::WARN, state.interface + " does not take all frames");
  if (grows("missed", state.frames_missed)) {
    complain(status, DiagnosticStatus::WARN, "frames came faster than this robot can take them");
  }
  add(status, "frames sent", state.frames_sent);
  add(status, "octets sent", state.bytes_sent);
  add(status, "frames received", state.frames_received);
  add(status, "octets received", state.bytes_received);
  add(status, "frames missed", state.frames_missed);
  add(status, "frames not sent", state.frames_not_sent);
  return status;
}

DiagnosticStatus Diagnostics::security(const NetworkState& state) {
  DiagnosticStatus status = healthy("frames are encrypted and authenticated");
  if (!state.sealed) {
    complain(status, DiagnosticStatus::WARN, "frames are neither encrypted nor authenticated: set ~key_file");
  }
  if (grows("forged", state.frames_forged)) complain(status, DiagnosticStatus::WARN, "forged frames are heard");
  if (grows("replayed", state.frames_replayed)) complain(status, DiagnosticStatus::WARN, "replayed frames are heard");
  add(status, "sealed", state.sealed ? "yes" : "no");
  return status;
}

DiagnosticStatus Diagnostics::neighbors(const NetworkState& state) {
  DiagnosticStatus status = healthy(std::to_string(state.links.size()) + " neighbours, " +
                                    std::to_string(state.robots.size()) + " robots known");
  if (own_name_is_taken(state)) {
    complain(status, DiagnosticStatus::ERROR,
             "two robots are called " + state.robot_name + ": give each its own ~robot_name");
  }
  for (const NetworkLink& link : state.links) {
    const std::string name = link.robot.empty() ? link.address : link.robot;
    if (!link.two_way) complain(status, DiagnosticStatus::WARN, name + " does not hear this robot");
    if (link.loss > kPoorLink) complain(status, DiagnosticStatus::WARN, percent(link.loss) + " lost to " + name);
    add(status, "loss to " + name, percent(link.loss) + (link.two_way ? "" : ", one way"));
  }
  return status;
}

DiagnosticStatus Diagnostics::queues(const NetworkState& state) {
  DiagnosticStatus status = healthy(std::to_string(state.packets_waiting) + " packets wait to be sent");
  if (state.packets_waiting > kManyPackets || state.octets_waiting > kManyOctets) {
    complain(status, DiagnosticStatus::WARN, "the send queue is nearly full");
  }
  add(status, "packets to send", state.packets_waiting);
  add(status, "octets to send", state.octets_waiting);
  std::uint64_t frames = 0;
  for (const NetworkLink& link : state.links) frames += link.waiting;
  add(status, "frames to send", frames);
  add(status, "packets to publish", state.packets_to_publish);
  add(status, "octets to publish", state.octets_to_publish);
  add(status, "packets sent", state.packets_sent);
  add(status, "packets failed", state.packets_failed);
  return status;
}

DiagnosticStatus Diagnostics::dropped_frames(const NetworkState& state) {
  DiagnosticStatus status = healthy("no frame was refused lately");
  const std::pair<const char*, std::uint64_t> reasons[] = {
      {"malformed", state.frames_malformed}, {"unsealed", state.frames_unsealed}, {"no key", state.frames_without_key},
      {"forged", state.frames_forged},       {"replayed", state.frames_replayed}, {"reflected", state.frames_reflected},
      {"unproven", state.frames_unproven}};
  for (const auto& [reason, count] : reasons) {
    add(status, reason, count);
    const bool expected = std::string(reason) == "unproven";  // each robot that starts causes some
    if (!expected && grows(reason + std::string(" frames"), count)) {
      complain(status, DiagnosticStatus::WARN, std::string("frames are refused: ") + reason);
    }
  }
  return status;
}

DiagnosticStatus Diagnostics::publishing(const NetworkState& state) {
  DiagnosticStatus status = healthy("every packet received was published");
  if (state.packets_not_published > 0) status.message = "no packet received was dropped lately";
  if (grows("publishing", state.packets_not_published)) {
    complain(status, DiagnosticStatus::WARN, "packets received cannot be published: see the node's log");
  }
  add(status, "packets not published", state.packets_not_published);
  return status;
}

DiagnosticStatus Diagnostics::relays(const NetworkState& state) {
  DiagnosticStatus status = healthy(std::to_string(state.relays.size()) + " topics are relayed");
  for (const RelayedTopic& relay : state.relays) {
    const std::string name = relay.topic + " to " + (relay.destination.empty() ? "all" : relay.destination) +
                             (relay.remote_topic.empty() ? "" : " as " + relay.remote_topic);
    if (grows("relay dropped " + name, relay.dropped)) {
      complain(status, DiagnosticStatus::WARN, name + ": messages are dropped");
    }
    if (grows("relay failed " + name, relay.failed)) {
      complain(status, DiagnosticStatus::WARN, name + ": " + relay.last_failure);
    }
    add(status, name,
        std::to_string(relay.delivered) + " delivered, " + std::to_string(relay.dropped) + " dropped, " +
            std::to_string(relay.failed) + " failed");
  }
  return status;
}

DiagnosticStatus Diagnostics::files(const NetworkState& state) {
  DiagnosticStatus status = healthy("logs and capture are complete");
  if (state.log_rows_lost + state.frames_not_captured > 0) status.message = "nothing was lost lately";
  if (grows("rows", state.log_rows_lost)) {
    complain(status, DiagnosticStatus::WARN, "rows of the logs are lost: is the disk of ~log_path full?");
  }
  if (grows("captured", state.frames_not_captured)) {
    complain(status, DiagnosticStatus::WARN, "captured frames are lost: is the disk of ~capture_file full?");
  }
  add(status, "log rows lost", state.log_rows_lost);
  add(status, "frames not captured", state.frames_not_captured);
  return status;
}

}  // namespace adhoc_communication
