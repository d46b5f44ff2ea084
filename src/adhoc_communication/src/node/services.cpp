#include "node/services.hpp"

#include <adhoc_communication/BroadcastCMgrRobotUpdate.h>
#include <adhoc_communication/BroadcastString.h>
#include <adhoc_communication/ChangeMCMembership.h>
#include <adhoc_communication/GetGroupState.h>
#include <adhoc_communication/GetNeighbors.h>
#include <adhoc_communication/Relay.h>
#include <adhoc_communication/SendCMgrRobotUpdate.h>
#include <adhoc_communication/SendExpAuction.h>
#include <adhoc_communication/SendExpCluster.h>
#include <adhoc_communication/SendExpFrontier.h>
#include <adhoc_communication/SendMessage.h>
#include <adhoc_communication/SendMmControl.h>
#include <adhoc_communication/SendMmMapUpdate.h>
#include <adhoc_communication/SendMmPoint.h>
#include <adhoc_communication/SendMmRobotPosition.h>
#include <adhoc_communication/SendOccupancyGrid.h>
#include <adhoc_communication/SendQuaternion.h>
#include <adhoc_communication/SendString.h>
#include <adhoc_communication/SendTwist.h>
#include <adhoc_communication/ShutDown.h>

#include <stdexcept>
#include <utility>

#include "node/message_kinds.hpp"
#include "node/network_state.hpp"
#include "node/options.hpp"
#include "relay/topic_name.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMaxSendThreads = 64;
constexpr int kMaxWaitingCalls = 60;  ///< fewer than threads, so that one call too many is refused at once
constexpr std::size_t kMaxQueryThreads = 4;

Bytes bytes_of_text(const std::string& text) {
  if (text.empty()) throw PayloadError("data is empty: there is nothing to send");
  return Bytes(text.begin(), text.end());
}

/// Throws std::invalid_argument.
Time lifetime_of(double seconds) {
  if (!(seconds >= 0.0 && seconds <= kLongestLifetime)) {
    throw std::invalid_argument("lifetime " + std::to_string(seconds) + " is outside 0 .. 86400 s");
  }
  return std::chrono::duration_cast<Time>(std::chrono::duration<double>(seconds));
}

/// What a call asks to be relayed. Throws std::invalid_argument, which names the relay.
RelayEntry relay_entry(const Relay::Request& request) {
  try {
    RelayEntry entry{request.topic,    request.destination,     parse_priority(request.priority),
                     request.rate,     request.latched != 0,    request.remote_topic,
                     request.lifetime, request.newest_only != 0};
    check_topics(entry);
    return entry;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("relay of '" + request.topic + "' to '" + request.destination + "' " + error.what());
  }
}

/// Counts the calls that wait for the radio and refuses those beyond the limit.
class WaitingCall {
 public:
  explicit WaitingCall(std::atomic<int>& count) : count_(count) {
    if (++count_ <= kMaxWaitingCalls) return;
    --count_;
    throw std::runtime_error(std::to_string(kMaxWaitingCalls) + " sends are under way already; try again later");
  }
  ~WaitingCall() { --count_; }
  WaitingCall(const WaitingCall&) = delete;
  WaitingCall& operator=(const WaitingCall&) = delete;

 private:
  std::atomic<int>& count_;
};

}  // namespace

Services::Services(ros::NodeHandle& node, const std::string& prefix, EngineHost& host, TopicRelay& relay,
                   ServiceLog& log, Terms terms, std::function<void()> shut_down)
    : prefix_(prefix),
      host_(host),
      relay_(relay),
      log_(log),
      terms_(std::move(terms)),
      sends_(kMaxSendThreads),
      queries_(kMaxQueryThreads) {
  advertise_sends(node);
  advertise_broadcasts(node);
  advertise_relay(node);
  advertise_queries(node, std::move(shut_down));
}

Services::~Services() { stop(); }

void Services::stop() {
  sends_.stop();
  queries_.stop();
}

template <typename Service>
void Services::advertise(ros::NodeHandle& node, ServicePool& pool, const std::string& name, Handler<Service> handler) {
  ros::AdvertiseServiceOptions options;
  options.init<typename Service::Request, typename Service::Response>(
      prefix_ + name, [handler](typename Service::Request& request, typename Service::Response& response) {
        handler(request, response);
        return true;
      });
  options.callback_queue = &pool;
  servers_.push_back(node.advertiseService(options));
}

template <typename Service, typename Member>
void Services::advertise_send(ros::NodeHandle& node, const std::string& name, Member member) {
  const MessageKind& kind = kind_of(name);
  advertise<Service>(node, sends_, name, [this, kind, member](auto& request, auto& response) {
    response.status =
        send(kind.service, {request.dst_robot, request.topic, static_cast<std::uint8_t>(kind.payload_type),
                            serialize(request.*member), kind.priority});
  });
}

void Services::advertise_sends(ros::NodeHandle& node) {
  advertise<SendString>(node, sends_, "send_string", [this](auto& request, auto& response) {
    const MessageKind& kind = kind_of("send_string");
    response.status =
        send(kind.service, {request.dst_robot, request.topic, static_cast<std::uint8_t>(kind.payload_type),
                            bytes_of_text(request.data), kind.priority});
  });
  advertise<SendMessage>(node, sends_, "send_message", [this](auto& request, auto& response) {
    const SerializedMessage message{request.type, request.md5sum, request.definition, request.data};
    SendRequest asked = any_message_request(request.dst_robot, request.topic, message);
    asked.lifetime = lifetime_of(request.lifetime);
    asked.newest_only = request.newest_only != 0;
    response.status = send("send_message", std::move(asked));
  });
  advertise_send<SendOccupancyGrid>(node, "send_map", &SendOccupancyGrid::Request::map);
  advertise_send<SendMmRobotPosition>(node, "send_position", &SendMmRobotPosition::Request::position);
  advertise_send<SendMmPoint>(node, "send_point", &SendMmPoint::Request::point);
  advertise_send<SendMmMapUpdate>(node, "send_map_update", &SendMmMapUpdate::Request::map_update);
  advertise_send<SendMmControl>(node, "send_control_message", &SendMmControl::Request::msg);
  advertise_send<SendExpFrontier>(node, "send_frontier", &SendExpFrontier::Request::frontier);
  advertise_send<SendExpCluster>(node, "send_cluster", &SendExpCluster::Request::cluster);
  advertise_send<SendExpAuction>(node, "send_auction", &SendExpAuction::Request::auction);
  advertise_send<SendTwist>(node, "send_twist", &SendTwist::Request::twist);
  advertise_send<SendQuaternion>(node, "send_quaternion", &SendQuaternion::Request::quaternion);
  advertise_send<SendCMgrRobotUpdate>(node, "send_robot_update", &SendCMgrRobotUpdate::Request::update);
}

void Services::advertise_broadcasts(ros::NodeHandle& node) {
  advertise<BroadcastString>(node, sends_, "broadcast_string", [this](auto& request, auto& response) {
    response.status = broadcast("broadcast_string", {request.topic, static_cast<std::uint8_t>(PayloadType::kString),
                                                     bytes_of_text(request.data), request.hop_limit});
  });
  advertise<BroadcastCMgrRobotUpdate>(node, sends_, "broadcast_robot_update", [this](auto& request, auto& response) {
    response.status =
        broadcast("broadcast_robot_update", {request.topic, static_cast<std::uint8_t>(PayloadType::kRobotUpdate),
                                             serialize(request.update), request.hop_limit});
  });
}

void Services::advertise_relay(ros::NodeHandle& node) {
  advertise<Relay>(node, queries_, "relay", [this](auto& request, auto& response) {
    if (request.action == Relay::Request::ADD) {
      relay_.add(relay_entry(request));
    } else if (request.action == Relay::Request::REMOVE) {
      relay_.remove(request.topic, request.destination, request.remote_topic);
    } else if (request.action != Relay::Request::LIST) {
      throw std::invalid_argument("action " + std::to_string(request.action) + " is none of 0 list, 1 add, 2 remove");
    }
    for (const RelayReport& report : relay_.reports()) response.relays.push_back(relayed_topic_message(report));
  });
}

void Services::advertise_queries(ros::NodeHandle& node, std::function<void()> shut_down) {
  advertise<ChangeMCMembership>(node, sends_, "join_mc_group", [this](auto& request, auto& response) {
    response.status = change_membership(request.group_name, request.action != 0);
  });
  advertise<GetNeighbors>(node, queries_, "get_neighbors",
                          [this](auto&, auto& response) { response.neigbors = host_.neighbors(); });
  advertise<GetGroupState>(node, queries_, "get_group_state", [this](auto& request, auto& response) {
    const GroupState state = host_.group_state(request.group_name);
    response.member = state.member;
    response.activated = state.activated;
    response.connected = state.connected;
    response.root = state.root;
    response.joining = state.joining;
    response.route_uplink = state.known ? state.route_uplink : "No mc entry found!";
    response.downlinks = state.downlinks;
  });
  advertise<ShutDown>(node, queries_, "shut_down", [shut_down = std::move(shut_down)](auto&, auto&) { shut_down(); });
}

std::uint8_t Services::send(const std::string& service, SendRequest request) {
  local_topic("", request.topic);  // what the receiver could not publish is refused here
  const std::size_t octets = request.payload.size();
  if (request.lifetime == Time(0)) request.lifetime = terms_.lifetime;
  request.newest_only |= terms_.newest_only.admits(local_topic("/", request.topic));
  return finish(service, octets, [&] { return host_.send(std::move(request)); });
}

std::uint8_t Services::broadcast(const std::string& service, BroadcastRequest request) {
  local_topic("", request.topic);
  const std::size_t octets = request.payload.size();
  request.lifetime = terms_.lifetime;
  return finish(service, octets, [&] { return host_.broadcast(std::move(request)); });
}

std::uint8_t Services::change_membership(const std::string& group, bool join) {
  return finish("join_mc_group", group.size(),
                [&] { return join ? host_.join_group(group) : host_.leave_group(group); });
}

/// Waits for the end of a call; 1, or an exception with the reason of the failure.
std::uint8_t Services::finish(const std::string& service, std::size_t octets, const std::function<Outcome()>& call) {
  const WaitingCall waiting(waiting_calls_);
  const long long begin = unix_milliseconds();
  const Outcome outcome = call();
  log_.add(service, begin, unix_milliseconds(), octets, outcome.succeeded);
  if (!outcome.succeeded) throw std::runtime_error(outcome.reason);
  return 1;
}

}  // namespace adhoc_communication
