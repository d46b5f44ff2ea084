// Every service of the node, by its advertised name.
#pragma once

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "node/engine_host.hpp"
#include "node/payload.hpp"
#include "node/service_log.hpp"
#include "node/service_pool.hpp"
#include "node/topic_relay.hpp"
#include "relay/topic_filter.hpp"

namespace adhoc_communication {

/// A handler that fails throws: roscpp carries the text of the exception to the caller, whereas returning false would
/// carry none.
class Services {
 public:
  /// For everything that is sent.
  struct Terms {
    Time lifetime{0};         ///< 0: none
    TopicFilter newest_only;  ///< topics of which a newer packet takes the place of one not begun yet
  };

  /// `prefix` is what precedes the short names of the services.
  Services(ros::NodeHandle& node, const std::string& prefix, EngineHost& host, TopicRelay& relay, ServiceLog& log,
           Terms terms, std::function<void()> shut_down);
  ~Services();

  /// Waits for the calls under way; stop the host first, so that they end.
  void stop();

 private:
  template <typename Service>
  using Handler = std::function<void(typename Service::Request&, typename Service::Response&)>;

  template <typename Service>
  void advertise(ros::NodeHandle& node, ServicePool& pool, const std::string& name, Handler<Service> handler);
  /// The service `name` sends the message that `member` of its request holds.
  template <typename Service, typename Member>
  void advertise_send(ros::NodeHandle& node, const std::string& name, Member member);
  void advertise_sends(ros::NodeHandle& node);
  void advertise_broadcasts(ros::NodeHandle& node);
  void advertise_relay(ros::NodeHandle& node);
  void advertise_queries(ros::NodeHandle& node, std::function<void()> shut_down);

  std::uint8_t send(const std::string& service, SendRequest request);
  std::uint8_t broadcast(const std::string& service, BroadcastRequest request);
  std::uint8_t change_membership(const std::string& group, bool join);
  std::uint8_t finish(const std::string& service, std::size_t octets, const std::function<Outcome()>& call);

  const std::string prefix_;
  EngineHost& host_;
  TopicRelay& relay_;
  ServiceLog& log_;
  const Terms terms_;
  std::atomic<int> waiting_calls_{0};
  ServicePool sends_;    ///< calls that wait for the radio
  ServicePool queries_;  ///< calls that are answered at once, however many sends wait
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace adhoc_communication
