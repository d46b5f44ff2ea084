// A topic of the ROS master whose subscribers have a bound in octets each.
#pragma once

#include <ros/node_handle.h>

#include <boost/shared_ptr.hpp>
#include <memory>
#include <string>

#include "node/errands.hpp"
#include "relay/local_topics.hpp"

namespace adhoc_communication {

/// The queues of ROS count messages only: a subscriber that hangs would keep a hundred maps of megabytes. So each
/// subscriber is handed messages one by one, and what it does not take waits here. Late subscribers of a latched topic
/// are given the last message.
class RosPublication : public Publication {
 public:
  /// `errands`: advertise the topic, and take that back.
  RosPublication(ros::NodeHandle& node, Errands& errands, const std::string& full_name,
                 const SerializedMessage& message, bool latched);
  ~RosPublication() override;

  bool offered() const override;
  std::string refusal() const override;
  std::size_t subscribers() const override;
  void publish(const SerializedMessage& message) override;
  bool serve() override;
  std::uint64_t take_dropped() override;

 private:
  class Subscribers;
  struct Offer;

  Errands& errands_;
  boost::shared_ptr<Subscribers> subscribers_;  ///< which threads of ROS tell of changes
  std::shared_ptr<Offer> offer_;
};

}  // namespace adhoc_communication
