// A robot without ROS: the node's engine host on an interface, driven by lines on standard input.
//
//   engine_host NAME INTERFACE [KEY]           KEY: 64 hexadecimal digits; without it, frames are open
//
//   map ROBOT OCTETS SEED                      sends one packet: {"sent": {seconds, reason, digest}}
//   stream ROBOT OCTETS SECONDS                keeps eight packets on their way: {"streamed": {packets, failed}}
//   look                                       {"look": {...}}: who is known, what was sent, heard and received so
//                                              far, processor time
//   echo on|off                                says of each packet received: {"packet": {time, octets, digest}}
//
// Times are of the monotonic clock, so that processes of one computer share them.
#include <sys/resource.h>

#include <cinttypes>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <sstream>

#include "adhoc_communication/compression.hpp"
#include "link/steady_now.hpp"
#include "node/engine_host.hpp"
#include "traffic.hpp"

namespace adhoc_communication::bench {
namespace {

constexpr int kOnTheirWay = 8;
constexpr int kLargestFrame = 1514;  ///< fills an MTU of 1500: 1400 octets of payload in each data frame

double in_seconds(Time time) { return static_cast<double>(time.count()) * 1e-9; }

struct ProcessorTime {
  double user;
  double system;
};

ProcessorTime processor_time() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {of(usage.ru_utime), of(usage.ru_stime)};
}

std::string quoted(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "\"" : ", \"") + name + "\"";
  return "[" + list + "]";
}

TeamKey key_of(const std::string& digits) {
  TeamKey key{};
  if (digits.size() != 2 * key.size()) throw std::invalid_argument("the key has not 64 hexadecimal digits");
  for (std::size_t i = 0; i < key.size(); ++i) {
    key[i] = static_cast<std::uint8_t>(std::stoul(digits.substr(2 * i, 2), nullptr, 16));
  }
  return key;
}

/// Limits how many packets are on their way.
class Slots {
 public:
  void take() {
    std::unique_lock<std::mutex> lock(mutex_);
    freed_.wait(lock, [this] { return taken_ < kOnTheirWay; });
    ++taken_;
  }
  void give_back(bool delivered) {
    const std::lock_guard<std::mutex> lock(mutex_);
    --taken_;
    ++(delivered ? delivered_ : failed_);
    freed_.notify_all();
  }
  std::pair<int, int> wait_for_all() {
    std::unique_lock<std::mutex> lock(mutex_);
    freed_.wait(lock, [this] { return taken_ == 0; });
    return {delivered_, failed_};
  }

 private:
  std::mutex mutex_;
  std::condition_variable freed_;
  int taken_ = 0;
  int delivered_ = 0;
  int failed_ = 0;
};

class Robot {
 public:
  Robot(const std::string& name, const std::string& interface, const std::string& key)
      : host_(options(name, key), open_link(interface, std::nullopt, name), ReceiveFilter(name, {}, {}, nullptr),
              {[this](PacketReceived packet) { take(packet); }, [](const std::string&) {}, [](const std::string&) {},
               [](const std::string& text) { std::cerr << text << std::endl; }}) {}

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string command, robot;
    words >> command;
    if (command == "map") {
      std::size_t octets = 0;
      std::uint64_t seed = 0;
      words >> robot >> octets >> seed;
      send_map(robot, octets, seed);
    } else if (command == "stream") {
      std::size_t octets = 0;
      double duration = 0;
      words >> robot >> octets >> duration;
      stream(robot, octets, duration);
    } else if (command == "echo") {
      words >> robot;
      echo_ = robot == "on";
    } else if (command == "look") {
      look();
    } else {
      std::cerr << "unknown command: " << line << std::endl;
    }
  }

 private:
  static EngineOptions options(const std::string& name, const std::string& key) {
    EngineOptions options;
    options.robot_name = name;
    options.max_frame_size = kLargestFrame;
    if (!key.empty()) options.keys = {key_of(key)};
    return options;
  }

  void send_map(const std::string& robot, std::size_t octets, std::uint64_t seed) {
    Bytes payload = incompressible(octets, seed);
    const std::uint64_t sum = digest(payload);
    const Time begin = steady_now();
    const Outcome outcome = host_.send({robot, "map", 'X', std::move(payload), Priority::kBulk});
    say("{\"sent\": {\"begin\": %.6f, \"seconds\": %.6f, \"reason\": \"%s\", \"digest\": \"%016" PRIx64 "\"}}",
        in_seconds(begin), in_seconds(steady_now() - begin), outcome.reason.c_str(), sum);
  }

  void stream(const std::string& robot, std::size_t octets, double duration) {
    const Bytes payload = incompressible(octets, 1);
    const Time end = steady_now() + Time(static_cast<Time::rep>(duration * 1e9));
    Slots slots;
    while (steady_now() < end) {
      slots.take();
      host_.send({robot, "stream", 'X', payload, Priority::kBulk},
                 [&slots](const Outcome& outcome) { slots.give_back(outcome.succeeded); });
    }
    const auto [delivered, failed] = slots.wait_for_all();
    say("{\"streamed\": {\"packets\": %d, \"failed\": %d}}", delivered, failed);
  }

  void look() {
    const Snapshot now = host_.snapshot();
    const ProcessorTime processor = processor_time();
    say("{\"look\": {\"robots\": %s, \"neighbors\": %s, \"frames_sent\": %" PRIu64 ", \"frames_received\": %" PRIu64
        ", \"user\": %.6f, \"system\": %.6f, \"received\": %" PRIu64 ", \"octets\": %" PRIu64 ", \"time\": %.6f}}",
        quoted(now.robots).c_str(), quoted(now.neighbors).c_str(), now.statistics.frames_sent,
        now.statistics.frames_received, processor.user, processor.system, received_.load(), octets_.load(),
        in_seconds(steady_now()));
  }

  void take(PacketReceived packet) {
    if (!unpack(packet)) return;
    ++received_;
    octets_ += packet.payload.size();
    if (!echo_) return;
    say("{\"packet\": {\"time\": %.6f, \"octets\": %zu, \"digest\": \"%016" PRIx64 "\"}}", in_seconds(steady_now()),
        packet.payload.size(), digest(packet.payload));
  }

  template <typename... Values>
  void say(const char* pattern, Values... values) {
    const std::lock_guard<std::mutex> lock(output_);
    std::printf(pattern, values...);
    std::printf("\n");
    std::fflush(stdout);
  }

  std::mutex output_;
  std::atomic<bool> echo_{false};
  std::atomic<std::uint64_t> received_{0};
  std::atomic<std::uint64_t> octets_{0};
  EngineHost host_;
};

}  // namespace
}  // namespace adhoc_communication::bench

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: engine_host NAME INTERFACE [KEY]\n");
    return 2;
  }
  try {
    adhoc_communication::bench::Robot robot(argv[1], argv[2], argc > 3 ? argv[3] : "");
    for (std::string line; std::getline(std::cin, line);) robot.obey(line);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "engine_host: %s\n", error.what());
    return 1;
  }
  return 0;
}
