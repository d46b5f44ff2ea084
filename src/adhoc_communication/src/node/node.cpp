#include "node/node.hpp"

#include <adhoc_communication/Status.h>
#include <nav_msgs/Odometry.h>
#include <ros/console.h>

#include <utility>

#include "link/mac_address.hpp"
#include "node/end_node.hpp"
#include "node/payload.hpp"
#include "node/ros_topics.hpp"
#include "security/cipher.hpp"

namespace adhoc_communication {
namespace {

constexpr double kStateInterval = 1.0;    // s
constexpr double kKeyFileInterval = 0.5;  // s
constexpr std::uint64_t kMegabyte = 1'000'000;

/// The link first, because it fails most: only then does the rest of the node come into being.
std::unique_ptr<Link> open_link_for(NodeOptions& options) {
  auto link = open_link(options.interface, options.mac, options.engine.robot_name);
  if (const auto warning = set_mtu(options, link->mtu())) ROS_WARN("The %s", warning->c_str());
  return link;
}

Services::Terms send_terms(const NodeOptions& options) {
  const std::chrono::duration<double> lifetime(options.send_lifetime);
  return {std::chrono::duration_cast<Time>(lifetime), TopicFilter(options.newest_only, "")};
}

void read_keys_for(NodeOptions& options) {
  if (options.key_file.empty()) {
    ROS_WARN(
        "Frames are neither encrypted nor authenticated, so everybody in range may listen and talk: make a key with "
        "\"rosrun adhoc_communication team_key create FILE\" and set parameter ~key_file");
    return;
  }
  options.engine.keys = read_key_file(options.key_file);
}

}  // namespace

Node::Node(const NodeOptions& options)
    : options_(options),
      name_prefix_(options.simulation_mode ? "/" + options.engine.robot_name + "/" : ""),
      service_prefix_(name_prefix_ + "adhoc_communication/"),
      log_(options.log_path, options.engine.robot_name),
      network_logs_(options.log_path, options.engine.robot_name),
      record_log_(options.log_path, options.engine.robot_name) {
  options_.engine.keep_records = record_log_.wanted();
  if (!options_.key_file.empty()) key_file_.emplace(options_.key_file);  // before reading: no change goes unnoticed
  read_keys_for(options_);
  auto link = captured(open_link_for(options_));
  ROS_INFO("%s on interface %s with address %s", options_.engine.robot_name.c_str(), options_.interface.c_str(),
           to_text(link->address()).c_str());
  injector_ =
      std::make_unique<Injector>(std::make_unique<RosTopics>(node_, name_prefix_), topic_filter(), inbox_calls());
  relay_ =
      std::make_unique<TopicRelay>(node_, name_prefix_, options_.engine.robot_name, options_.engine.max_packet_size);
  discovery_ = std::make_unique<Discovery>(node_, service_prefix_ + options_.topic_new_robot,
                                           service_prefix_ + options_.topic_remove_robot);
  ReceiveFilter filter(options_.engine.robot_name, options_.sim_robot_macs, options_.channel,
                       options_.simulation_mode ? &positions_ : nullptr);
  if (options_.simulation_mode) follow_ground_truth();
  host_ = std::make_unique<EngineHost>(options_.engine, std::move(link), std::move(filter), callbacks());
  security::wipe(options_.engine.keys);
  carry_relays();
  services_ = std::make_unique<Services>(node_, service_prefix_, *host_, *relay_, log_, send_terms(options_),
                                         [this] { shut_down(); });
  status_publisher_ = node_.advertise<Status>(service_prefix_ + "status", 1, true);
  network_state_publisher_ = node_.advertise<NetworkState>(service_prefix_ + "network_state", 1, true);
  diagnostics_publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  state_timer_ = node_.createWallTimer(ros::WallDuration(kStateInterval), &Node::tell_state, this);
  if (!key_file_) return;
  key_timer_ = node_.createWallTimer(ros::WallDuration(kKeyFileInterval), &Node::reread_keys, this);
}

Node::~Node() {
  relay_->stop();
  host_->stop();  // calls that wait end here, so that the services can stop
  services_->stop();
  injector_.reset();  // its thread asks robots for definitions, by the host
}

std::unique_ptr<Link> Node::captured(std::unique_ptr<Link> link) {
  if (options_.capture_file.empty()) return link;
  capture_ = std::make_shared<CaptureFile>(options_.capture_file,
                                           static_cast<std::uint64_t>(options_.capture_size) * kMegabyte);
  return std::make_unique<CaptureLink>(std::move(link), capture_);
}

void Node::carry_relays() {
  for (const RelayEntry& entry : options_.relays) relay_->add(entry);
  relay_->start([this](SendRequest request, Waiter waiter) { host_->send(std::move(request), std::move(waiter)); });
}

HostCallbacks Node::callbacks() {
  return {[this](PacketReceived packet) {
            if (!packet.group.empty()) relay_->group_packet(packet);
            injector_->inject(std::move(packet));
          },
          [this](const std::string& robot) {
            discovery_->announce(robot);
            relay_->robot_appeared(robot);
          },
          [this](const std::string& robot) {
            discovery_->announce_loss(robot);
            relay_->robot_lost(robot);
          },
          [this](const std::string& text) { ROS_WARN("Interface %s: %s", options_.interface.c_str(), text.c_str()); },
          end_node,
          [](const std::string& robot) {
            ROS_ERROR("Two robots are called %s, or use its hardware address: give each its own ~robot_name",
                      robot.c_str());
          },
          [this](std::vector<Record> records, Time now) { record_log_.add(std::move(records), now); }};
}

InboxCalls Node::inbox_calls() {
  return {decode, [this](const std::string& robot, const TypeName& type) { relay_->ask(robot, type); },
          [this](const PacketReceived& request) { relay_->answer(request); },
          [this](const PacketReceived& word) { relay_->new_member(word); },
          [](const std::string& text) { ROS_ERROR("%s", text.c_str()); }};
}

/// What this node publishes itself, other robots may not.
TopicFilter Node::topic_filter() const {
  TopicFilter filter(options_.inject_allow, options_.inject_deny);
  filter.never(node_.resolveName(name_prefix_ + "adhoc_communication") + "/*");
  return filter;
}

/// A file that cannot be used leaves the keys as they are.
void Node::reread_keys(const ros::WallTimerEvent&) {
  if (!key_file_->changed()) return;
  try {
    host_->set_keys(read_key_file(options_.key_file));
    ROS_INFO("The keys of '%s' are in use", options_.key_file.c_str());
  } catch (const std::invalid_argument& error) {
    ROS_ERROR("The keys stay as they were: %s", error.what());
  }
}

void Node::follow_ground_truth() {
  for (int i = 0; i < options_.robots_in_simulation; ++i) {
    const std::string robot = "robot_" + std::to_string(i);
    const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> store =
        [this, robot](const nav_msgs::Odometry::ConstPtr& odometry) {
          positions_.set(robot, {odometry->pose.pose.position.x, odometry->pose.pose.position.y});
        };
    ground_truth_.push_back(node_.subscribe<nav_msgs::Odometry>("/" + robot + "/base_pose_ground_truth", 1, store));
  }
}

NodeState Node::state(const Snapshot& snapshot) const {
  NodeState state;
  state.stamp = ros::Time::now();
  state.robot_name = options_.engine.robot_name;
  state.interface = options_.interface;
  state.address = snapshot.address;
  state.sealed = key_file_.has_value();
  state.relays = relay_->reports();
  state.injector = injector_->report();
  state.log_rows_lost =
      log_.rows_lost() + network_logs_.rows_lost() + record_log_.rows_lost() + snapshot.statistics.records_lost;
  if (capture_) state.frames_not_captured = capture_->frames_lost();
  return state;
}

void Node::tell_state(const ros::WallTimerEvent&) {
  const Snapshot snapshot = host_->snapshot();
  const NodeState own = state(snapshot);
  const NetworkState network = network_state_message(snapshot, own);
  status_publisher_.publish(status_message(snapshot, own));
  network_state_publisher_.publish(network);
  diagnostics_publisher_.publish(diagnostics_.report(network));
  network_logs_.add(snapshot, unix_milliseconds());
  tell_rows_lost(own.log_rows_lost);
  const auto group = snapshot.groups.find("mc_" + options_.engine.robot_name);
  if (group != snapshot.groups.end()) relay_->group_members(group->second.members);
}

/// Once: what is lost after that is counted.
void Node::tell_rows_lost(std::uint64_t rows) {
  if (rows == 0 || std::exchange(disk_full_told_, true)) return;
  ROS_WARN("Rows of the logs in ~log_path = %s are lost: is the disk full? All else goes on; /diagnostics counts them",
           options_.log_path.c_str());
}

void Node::shut_down() {
  ROS_INFO("Shutting down as asked by service shut_down");
  asked_to_end = true;
}

}  // namespace adhoc_communication
