#include "node/ros_publication.hpp"

#include <ros/serialization.h>
#include <ros/single_subscriber_publisher.h>
#include <ros/subscriber_link.h>

#include <algorithm>
#include <atomic>
#include <boost/make_shared.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "relay/subscriber_queue.hpp"

namespace adhoc_communication {
namespace {

/// What one subscriber has been handed and has not taken.
struct InHand {
  std::atomic<std::size_t> messages{0};
  std::atomic<std::size_t> octets{0};
};

constexpr std::size_t kLengthSize = 4;

SubscriberQueue::Message with_length(const Bytes& octets) {
  auto message = std::make_shared<Bytes>(kLengthSize + octets.size());
  ros::serialization::OStream stream(message->data(), kLengthSize);
  stream.next(static_cast<std::uint32_t>(octets.size()));
  std::copy(octets.begin(), octets.end(), message->begin() + kLengthSize);
  return message;
}

/// All subscribers share the octets; when ROS has let go of them, this one has taken them.
ros::SerializedMessage handed(const SubscriberQueue::Message& message, const std::shared_ptr<InHand>& in_hand) {
  ++in_hand->messages;
  in_hand->octets += message->size();
  const auto taken = [message, in_hand](std::uint8_t*) {
    --in_hand->messages;
    in_hand->octets -= message->size();
  };
  ros::SerializedMessage result;
  result.buf = boost::shared_array<std::uint8_t>(const_cast<std::uint8_t*>(message->data()), taken);
  result.num_bytes = message->size();
  result.message_start = result.buf.get() + kLengthSize;
  return result;
}

/// ROS says who has connected by an object that cannot be kept; what it stands for can, but is private. An explicit
/// instantiation may name it.
template <auto kLink>
struct LinkOf {
  friend const ros::SubscriberLinkPtr& link_of(const ros::SingleSubscriberPublisher& subscriber) {
    return subscriber.*kLink;
  }
};
const ros::SubscriberLinkPtr& link_of(const ros::SingleSubscriberPublisher& subscriber);
template struct LinkOf<&ros::SingleSubscriberPublisher::link_>;

}  // namespace

class RosPublication::Subscribers {
 public:
  explicit Subscribers(bool latched) : latched_(latched) {}

  void connected(const ros::SubscriberLinkPtr& link) {
    const std::lock_guard<std::mutex> lock(mutex_);
    all_.push_back({link, {}, std::make_shared<InHand>()});
    if (last_) all_.back().queue.add(last_);
    all_.back().serve();
  }
  void disconnected(const ros::SubscriberLinkPtr& link) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto is_lost = [&](const Subscriber& subscriber) { return subscriber.link == link; };
    all_.erase(std::remove_if(all_.begin(), all_.end(), is_lost), all_.end());
  }
  void publish(const Bytes& octets) {
    const SubscriberQueue::Message message = with_length(octets);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (latched_) last_ = message;
    for (Subscriber& subscriber : all_) dropped_ += subscriber.queue.add(message);
  }
  bool serve() {
    const std::lock_guard<std::mutex> lock(mutex_);
    bool waits = false;
    for (Subscriber& subscriber : all_) waits = subscriber.serve() || waits;
    return waits;
  }
  std::size_t size() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return all_.size();
  }
  std::uint64_t take_dropped() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(dropped_, 0);
  }

 private:
  struct Subscriber {
    ros::SubscriberLinkPtr link;
    SubscriberQueue queue;
    std::shared_ptr<InHand> in_hand;

    /// True while something waits.
    bool serve() {
      while (const auto message = queue.next({in_hand->messages, in_hand->octets})) {
        link->enqueueMessage(handed(message, in_hand), true, true);
      }
      return !queue.empty();
    }
  };

  const bool latched_;
  mutable std::mutex mutex_;
  std::vector<Subscriber> all_;
  SubscriberQueue::Message last_;
  std::uint64_t dropped_ = 0;
};

/// Shared with the errands.
struct RosPublication::Offer {
  enum class State { kPending, kMade, kRefused };

  ros::Publisher publisher;  ///< of the thread of the errands
  std::string refusal;       ///< set before the state
  std::atomic<State> state{State::kPending};
};

RosPublication::RosPublication(ros::NodeHandle& node, Errands& errands, const std::string& full_name,
                               const SerializedMessage& message, bool latched)
    : errands_(errands), subscribers_(boost::make_shared<Subscribers>(latched)), offer_(std::make_shared<Offer>()) {
  ros::AdvertiseOptions options(full_name, SubscriberQueue::kMostMessages, message.md5sum, message.type,
                                message.definition);
  options.latch = latched;
  options.connect_cb = [all = subscribers_.get()](const auto& subscriber) { all->connected(link_of(subscriber)); };
  options.disconnect_cb = [all = subscribers_.get()](const auto& subscriber) {
    all->disconnected(link_of(subscriber));
  };
  options.tracked_object = subscribers_;  // ROS calls these two only as long as it is there
  errands_.add([node, options, offer = offer_]() mutable {
    try {
      offer->publisher = node.advertise(options);
    } catch (const ros::Exception&) {
    }
    options.tracked_object.reset();
    if (!offer->publisher) offer->refusal = "topic '" + options.topic + "' cannot be advertised as " + options.datatype;
    offer->state = offer->publisher ? Offer::State::kMade : Offer::State::kRefused;
  });
}

/// Also what the offer holds ends there: to take it back asks the master.
RosPublication::~RosPublication() {
  errands_.add([offer = std::move(offer_)] { offer->publisher.shutdown(); });
}

bool RosPublication::offered() const { return offer_->state == Offer::State::kMade; }
std::string RosPublication::refusal() const {
  return offer_->state == Offer::State::kRefused ? offer_->refusal : std::string();
}

std::size_t RosPublication::subscribers() const { return subscribers_->size(); }
void RosPublication::publish(const SerializedMessage& message) { subscribers_->publish(message.bytes); }
bool RosPublication::serve() { return subscribers_->serve(); }
std::uint64_t RosPublication::take_dropped() { return subscribers_->take_dropped(); }

}  // namespace adhoc_communication
