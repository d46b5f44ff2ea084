// The topics of the ROS master, which is asked and told by a thread of its own: it may hang.
#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "node/errands.hpp"
#include "relay/local_topics.hpp"

namespace adhoc_communication {

class RosTopics : public LocalTopics {
 public:
  /// `prefix` is put before every topic: /<self>/ in simulation mode, else empty.
  RosTopics(ros::NodeHandle node, std::string prefix);

  std::string full_name(const std::string& topic) const override;
  void ask() override;
  std::optional<Answer> take_answer() override;
  std::unique_ptr<Publication> advertise(const std::string& full_name, const SerializedMessage& message,
                                         bool latched) override;

 private:
  /// More than there can be: of each topic two, and one question, without whose answer no topic is new.
  static constexpr std::size_t kMostErrands = 1000;

  ros::NodeHandle node_;
  const std::string prefix_;
  std::mutex mutex_;
  std::optional<Answer> answer_;
  Errands errands_{kMostErrands};  ///< last, as they use the others
};

}  // namespace adhoc_communication
