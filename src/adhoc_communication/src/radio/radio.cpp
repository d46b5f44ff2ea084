#include "radio/radio.hpp"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "link/steady_now.hpp"
#include "radio/control.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMaxClients = 1000;

}  // namespace

Radio::Radio(const RadioOptions& options)
    : medium_(in_real_time(options.medium, options.rtf), options.seed),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      timer_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
  for (const auto& [robot, interface] : options.interfaces) {
    auto port = std::make_unique<InterfacePort>(interface, robot);
    const Medium::Node node = medium_.add_node(robot);
    node_of_descriptor_[port->descriptor()] = node;
    watch(port->descriptor());
    ports_[node] = std::move(port);
  }
  if (!options.hub.empty()) {
    hub_ = std::make_unique<ListeningSocket>(options.hub);
    watch(hub_->descriptor());
  }
  if (!options.control.empty()) {
    control_ = std::make_unique<ListeningSocket>(options.control);
    watch(control_->descriptor());
  }
  watch(timer_.get());
}

void Radio::watch(int descriptor) {
  struct epoll_event event {};
  event.events = EPOLLIN;
  event.data.fd = descriptor;
  epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, descriptor, &event);
}

void Radio::run(int signals) {
  watch(signals);
  std::array<struct epoll_event, 64> events;
  for (;;) {
    const int count = epoll_wait(epoll_.get(), events.data(), events.size(), -1);
    const Time now = steady_now();
    for (int i = 0; i < count; ++i) {
      if (events[i].data.fd == signals) return;
      serve(events[i].data.fd, now);
    }
    deliver(now);
    arm_timer();
  }
}

void Radio::serve(int descriptor, Time now) {
  const auto node = node_of_descriptor_.find(descriptor);
  if (node != node_of_descriptor_.end()) return carry_frames(node->second, now);
  if (hub_ && descriptor == hub_->descriptor()) return accept_hub_client();
  if (control_ && descriptor == control_->descriptor()) return accept_control_client();
  if (unnamed_clients_.count(descriptor) != 0) return name_hub_client(descriptor, now);
  if (control_clients_.count(descriptor) != 0) return serve_control_client(descriptor, now);
  std::uint64_t expirations = 0;  // the timer: deliver() does the rest
  if (::read(timer_.get(), &expirations, sizeof expirations) < 0) return;
}

void Radio::accept_hub_client() {
  FileDescriptor socket = hub_->accept();
  if (!socket.is_open() || unnamed_clients_.size() >= kMaxClients) return;
  const int descriptor = socket.get();
  watch(descriptor);
  unnamed_clients_[descriptor] = std::make_unique<HubPort>(std::move(socket));
}

void Radio::name_hub_client(int descriptor, Time now) {
  auto client = std::move(unnamed_clients_[descriptor]);
  unnamed_clients_.erase(descriptor);
  const auto name = client->receive_name();
  if (!name || name->empty()) return;  // closes the connection
  Medium::Node node{};
  try {
    node = node_named(medium_, *name);
  } catch (const std::invalid_argument& error) {
    std::cerr << "radio: " << error.what() << std::endl;
    return;
  }
  const auto former = ports_.find(node);
  if (former != ports_.end()) node_of_descriptor_.erase(former->second->descriptor());  // a robot that started again
  medium_.set_up(node, true, now);
  node_of_descriptor_[descriptor] = node;
  ports_[node] = std::move(client);
}

void Radio::accept_control_client() {
  FileDescriptor socket = control_->accept();
  if (!socket.is_open() || control_clients_.size() >= kMaxClients) return;
  watch(socket.get());
  const int descriptor = socket.get();
  control_clients_[descriptor] = std::move(socket);
}

void Radio::serve_control_client(int descriptor, Time now) {
  std::array<char, 65536> buffer;
  const ssize_t size = recv(descriptor, buffer.data(), buffer.size(), 0);
  if (size <= 0) {
    control_clients_.erase(descriptor);
    return;
  }
  std::istringstream lines(std::string(buffer.data(), static_cast<std::size_t>(size)));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    const std::string answer = line == "statistics" ? statistics() : carry_out(line, medium_, now);
    if (answer.empty()) continue;
    if (line != "statistics") std::cerr << "radio: " << answer << std::endl;
    ::send(descriptor, answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
}

void Radio::carry_frames(Medium::Node node, Time now) {
  Port& port = *ports_.at(node);
  const int descriptor = port.descriptor();
  port.receive([&](const Frame& frame, Time) { medium_.transmit(node, frame, now); });
  if (port.is_open()) return;
  node_of_descriptor_.erase(descriptor);
  ports_.erase(node);
  medium_.set_up(node, false, now);
}

void Radio::deliver(Time now) {
  for (const auto& delivery : medium_.deliveries(now)) {
    const auto port = ports_.find(delivery.node);
    if (port != ports_.end()) port->second->send(*delivery.frame);
  }
}

void Radio::arm_timer() {
  struct itimerspec setting {};
  if (const auto next = medium_.next_delivery()) {
    const Time at = std::max(*next, Time(1));  // zero would disarm the timer
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(at);
    setting.it_value.tv_sec = seconds.count();
    setting.it_value.tv_nsec = (at - seconds).count();
  }
  timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &setting, nullptr);
}

std::string Radio::statistics() const { return statistics_json(medium_); }

}  // namespace adhoc_communication
