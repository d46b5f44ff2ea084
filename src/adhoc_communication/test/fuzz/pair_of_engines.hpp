// Two engines in reach of each other and of strangers, whose promises are checked while a fuzzer plays with them.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <set>

#include "adhoc_communication/engine.hpp"
#include "operations.hpp"
#include "random.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::fuzz {

/// Ends the program with abort() when an engine breaks a promise.
class PairOfEngines {
 public:
  /// `sealed`: the engines have a key, which the fuzzer has, too.
  explicit PairOfEngines(bool sealed = false);

  void carry_out(Operands& operands);
  /// Every send has to end by itself.
  void finish();

  /// Types of the fuzzer's own frames that an engine took, checksum and sender being right.
  const std::set<wire::FrameType>& taken() const { return taken_; }

  static MacAddress address(std::size_t robot) { return {2, 0, 0, 0, 0, static_cast<std::uint8_t>(robot)}; }
  static BootId boot_id(std::size_t robot, int run);

 private:
  struct Robot {
    std::unique_ptr<Engine> engine;
    int runs = 0;
    std::set<SendId> open;
  };

  void boot(std::size_t robot);
  void hear_frame(Operands& operands);
  void hear(std::size_t robot, wire::FrameHeader header, bool open, const Bytes& body);
  void hear_raw(Operands& operands);
  void send(Operands& operands);
  void flood(Operands& operands);
  void advance(Time duration);
  /// Polls both engines until nothing is due, and carries their frames over.
  void settle();
  void poll(std::size_t robot);
  void take_events(Robot& robot);
  void check(const Robot& robot) const;
  std::string name_of(std::uint8_t choice) const;

  const bool sealed_;
  std::array<Robot, 2> robots_;
  std::deque<Frame> air_;
  Random random_{1};
  Time now_{0};
  Time played_{0};
  int loss_ = 0;  ///< of 256
  std::uint64_t counter_ = 0;
  std::set<wire::FrameType> taken_;
};

}  // namespace adhoc_communication::fuzz
