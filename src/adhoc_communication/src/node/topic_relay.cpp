#include "node/topic_relay.hpp"

#include <ros/this_node.h>
#include <topic_tools/shape_shifter.h>

#include <chrono>
#include <utility>

#include "link/steady_now.hpp"
#include "node/end_node.hpp"
#include "relay/topic_name.hpp"
#include "run_guarded.hpp"

namespace adhoc_communication {
namespace {

constexpr std::uint32_t kSubscriberQueue = 256;  // emptied at once: what has to wait, waits in the table

SerializedMessage serialized(const topic_tools::ShapeShifter& shape) {
  SerializedMessage message{shape.getDataType(), shape.getMD5Sum(), shape.getMessageDefinition(), Bytes(shape.size())};
  ros::serialization::OStream stream(message.bytes.data(), static_cast<std::uint32_t>(message.bytes.size()));
  shape.write(stream);
  return message;
}

}  // namespace

TopicRelay::TopicRelay(ros::NodeHandle node, std::string prefix, const std::string& own_name,
                       std::size_t max_packet_size)
    : node_(std::move(node)), prefix_(std::move(prefix)), table_(own_name, max_packet_size) {}

void TopicRelay::start(Send send) {
  send_ = std::move(send);
  thread_ = std::thread([this] { run(); });
}

void TopicRelay::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  arrivals_.stop();
  if (thread_.joinable()) thread_.join();
}

void TopicRelay::add(RelayEntry entry) {
  const std::string topic = local_topic(prefix_, entry.topic);
  RelayTable::Id id = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    id = table_.add(std::move(entry));
  }
  // Outside the lock: roscpp may deliver a message while it subscribes.
  using Event = ros::MessageEvent<topic_tools::ShapeShifter const>;
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>(topic, kSubscriberQueue,
                                               [this, id](const Event& event) { take(id, event); });
  options.callback_queue = &arrivals_;
  ros::Subscriber subscriber = node_.subscribe(options);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!subscriber) {
    table_.remove(id);
    throw std::invalid_argument("relay of '" + topic + "': the ROS master does not answer");
  }
  if (table_.has(id)) std::swap(subscribers_[id], subscriber);  // it may have been removed meanwhile
}

void TopicRelay::remove(const std::string& topic, const std::string& destination, const std::string& remote_topic) {
  std::vector<ros::Subscriber> ended;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const RelayTable::Id id : table_.remove(topic, destination, remote_topic)) {
      ended.push_back(subscribers_[id]);
      subscribers_.erase(id);
    }
  }
  if (ended.empty()) throw std::invalid_argument("no relay of '" + topic + "' to '" + destination + "' exists");
}

std::vector<RelayReport> TopicRelay::reports() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return table_.reports();
}

void TopicRelay::take(RelayTable::Id id, const ros::MessageEvent<topic_tools::ShapeShifter const>& event) {
  if (event.getPublisherName() == ros::this_node::getName()) return;
  SerializedMessage message = serialized(*event.getConstMessage());
  const auto latching = event.getConnectionHeader().find("latching");
  message.latched = latching != event.getConnectionHeader().end() && latching->second == "1";
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.offer(id, std::make_shared<const SerializedMessage>(std::move(message)), steady_now());
  changed_.notify_one();
}

void TopicRelay::robot_appeared(const std::string& robot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.robot_appeared(robot, steady_now());
  changed_.notify_one();
}

void TopicRelay::robot_lost(const std::string& robot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.robot_lost(robot);
}

void TopicRelay::group_members(const std::vector<std::string>& members) {
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.group_members(members, steady_now());
  changed_.notify_one();
}

void TopicRelay::group_packet(const PacketReceived& packet) {
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.group_packet(packet);
}

void TopicRelay::new_member(const PacketReceived& word) {
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.new_member(word, steady_now());
  changed_.notify_one();
}

void TopicRelay::ask(const std::string& robot, const TypeName& type) {
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.ask(robot, type);
  changed_.notify_one();
}

void TopicRelay::answer(const PacketReceived& request) {
  const std::lock_guard<std::mutex> lock(mutex_);
  table_.answer(request);
  changed_.notify_one();
}

void TopicRelay::send(RelayTable::Transfer transfer) {
  send_(std::move(transfer.request), [this, number = transfer.number](const Outcome& outcome) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (outcome.superseded) {
      table_.superseded(number);
    } else {
      table_.finished(number, outcome.succeeded, outcome.reason, steady_now(), outcome.missed);
    }
    changed_.notify_one();
  });
}

void TopicRelay::run() {
  run_guarded(
      "relaying", [this] { work(); }, end_node);
}

void TopicRelay::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    if (auto transfer = table_.next(steady_now())) {
      lock.unlock();
      send(std::move(*transfer));
      lock.lock();
      continue;
    }
    const Time deadline = table_.next_deadline();
    if (deadline == Time::max()) {
      changed_.wait(lock);
    } else {
      changed_.wait_until(lock, std::chrono::steady_clock::time_point(deadline));
    }
  }
}

}  // namespace adhoc_communication
