// A robot and a hundred neighbours that hear it but not each other; all talk to it and, over it, to each other.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "random.hpp"
#include "separate_engine.hpp"

namespace adhoc_communication::bench {

class Crowd {
 public:
  static constexpr std::size_t kNeighbors = 100;
  static constexpr Time kDelay = std::chrono::microseconds(100);  ///< of each frame
  static constexpr Time kInterval = std::chrono::seconds(10);     ///< between two packets of a neighbour

  explicit Crowd(const std::vector<TeamKey>& keys);

  void run_for(Time duration);
  /// Hands frames of anybody to the robot in the middle.
  void inject(const std::vector<Frame>& frames) { step_middle(frames); }
  /// A neighbour forgets everything and begins a new run.
  void restart(std::size_t neighbor);

  Time now() const { return now_; }
  std::size_t resident() const { return resident_; }  ///< kB of the robot in the middle
  std::size_t peak() const { return peak_; }
  std::uint64_t delivered() const { return delivered_; }  ///< packets that neighbours received
  /// The latest frames of neighbours, oldest first.
  const std::deque<Frame>& recorded() const { return recorded_; }

  static MacAddress address(std::size_t robot) { return {2, 0, 0, 0, 1, static_cast<std::uint8_t>(robot)}; }
  static MacAddress middle() { return address(kNeighbors); }

 private:
  struct Neighbor {
    std::unique_ptr<Engine> engine;
    std::uint64_t boots = 0;
    Time deadline{0};
    Time sends_at{0};
  };
  struct Flight {
    Time arrives;
    std::size_t to;  ///< kNeighbors: the robot in the middle
    Frame frame;
  };

  static constexpr std::size_t kMostRecorded = 4000;

  static std::string name(std::size_t robot) { return "robot_" + std::to_string(robot); }
  EngineOptions options(std::size_t robot) const;
  void boot(std::size_t neighbor);
  Time next() const;
  void serve(std::size_t neighbor);
  void land();
  void step_middle(const std::vector<Frame>& frames);
  void send_something(std::size_t neighbor);

  std::vector<TeamKey> keys_;
  SeparateEngine middle_;
  Random random_{1};
  Time now_{0};
  Time middle_deadline_{0};
  std::vector<Neighbor> neighbors_;
  std::deque<Flight> flights_;
  std::deque<Frame> recorded_;
  std::uint64_t delivered_ = 0;
  std::size_t resident_ = 0;
  std::size_t peak_ = 0;
};

}  // namespace adhoc_communication::bench
