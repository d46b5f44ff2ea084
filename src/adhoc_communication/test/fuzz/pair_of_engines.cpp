#include "pair_of_engines.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "adhoc_communication/compression.hpp"
#include "security/cipher.hpp"

namespace adhoc_communication::fuzz {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMtu = 1500;
constexpr int kMostPolls = 10'000;  ///< at one moment
constexpr Time kPatience = 60s;
constexpr Time kLongestPlay = 1s;  ///< of all kAdvance together
constexpr std::size_t kStrangers = 6;
constexpr std::size_t kLargestPacket = 50'000;
constexpr TeamKey kTeamKey{7};
constexpr std::size_t kLargestPayload = 6000;  ///< a few segments; more only take time

[[noreturn]] void broken(const std::string& promise) {
  std::fprintf(stderr, "%s\n", promise.c_str());
  std::abort();
}

}  // namespace

PairOfEngines::PairOfEngines(bool sealed) : sealed_(sealed) {
  boot(0);
  boot(1);
  settle();
}

BootId PairOfEngines::boot_id(std::size_t robot, int run) {
  BootId boot_id{};
  boot_id[0] = static_cast<std::uint8_t>(1 + robot);
  boot_id[1] = static_cast<std::uint8_t>(run);
  return boot_id;
}

void PairOfEngines::boot(std::size_t robot) {
  EngineOptions options;
  options.robot_name = "robot_" + std::to_string(robot);
  options.max_packet_size = kLargestPacket;
  if (sealed_) options.keys = {kTeamKey};
  Robot& entry = robots_[robot];
  ++entry.runs;
  entry.open.clear();
  entry.engine = std::make_unique<Engine>(options, address(robot), boot_id(robot, entry.runs), 1 + robot, now_);
}

void PairOfEngines::carry_out(Operands& operands) {
  switch (operands.operation()) {
    case Operation::kFrame:
      hear_frame(operands);
      break;
    case Operation::kRaw:
      hear_raw(operands);
      break;
    case Operation::kSend:
      send(operands);
      break;
    case Operation::kFlood:
      flood(operands);
      break;
    case Operation::kJoin: {
      Engine& engine = *robots_[operands.u8() % 2].engine;
      engine.join_group("mc_" + name_of(operands.u8()), now_);
      break;
    }
    case Operation::kLeave: {
      Engine& engine = *robots_[operands.u8() % 2].engine;
      engine.leave_group("mc_" + name_of(operands.u8()), now_);
      break;
    }
    case Operation::kAdvance:
      advance(std::min(operands.u8() * Time(1ms), kLongestPlay - played_));
      break;
    case Operation::kJump:
      now_ += operands.u8() * Time(100ms);
      break;
    case Operation::kLose:
      loss_ = operands.u8();
      break;
    case Operation::kRestart:
      boot(operands.u8() % 2);
      break;
    case Operation::kCount:
      break;
  }
  settle();
  for (const Robot& robot : robots_) check(robot);
}

/// The body is the fuzzer's; what would keep it from being looked at is right.
void PairOfEngines::hear_frame(Operands& operands) {
  const std::size_t robot = operands.u8() % 2;
  const std::size_t sender = operands.u8() % (2 + kStrangers);
  const std::uint8_t type = operands.u8();
  const std::uint8_t flags = operands.u8();
  if (sender == robot) return;
  wire::FrameHeader header;
  header.type = static_cast<wire::FrameType>(1 + type % (Statistics::kFrameTypes - 1));
  header.flags = flags & (wire::kWantsAcknowledgment | wire::kAcknowledgeNow);
  header.sender = address(sender);
  header.boot_id = boot_id(sender, (flags & 0x80) != 0 ? 0 : 1);
  header.counter = ++counter_;
  header.next_hop = (flags & 0x40) != 0 ? wire::kEverybody : address(robot);
  header.link_sequence = operands.u8();
  hear(robot, header, (flags & 0x20) != 0, operands.octets(operands.u8()));
}

/// `open`: also where the team seals its frames.
void PairOfEngines::hear(std::size_t robot, wire::FrameHeader header, bool open, const Bytes& body) {
  Engine& engine = *robots_[robot].engine;
  const auto type = static_cast<std::size_t>(header.type);
  const std::uint64_t before = engine.statistics().frames_received_by_type[type];
  Bytes frame;
  if (sealed_ && !open) {
    header.flags |= wire::kSealed;
    security::SessionKey key;
    security::derive_session_key(key, kTeamKey, header.sender, header.boot_id);
    frame = security::seal(key, header, body);
  } else {
    frame = wire::close_openly(header, body);
  }
  engine.receive({header.next_hop, header.sender, frame}, now_);
  if (engine.statistics().frames_received_by_type[type] > before) taken_.insert(header.type);
}

void PairOfEngines::hear_raw(Operands& operands) {
  const std::size_t robot = operands.u8() % 2;
  const Bytes octets = operands.octets(operands.u8());
  robots_[robot].engine->receive({address(robot), address(1 - robot), octets}, now_);
}

void PairOfEngines::send(Operands& operands) {
  Robot& robot = robots_[operands.u8() % 2];
  const std::uint8_t destination = operands.u8();
  SendRequest request;
  request.destination = (destination & 0x40) != 0 ? "" : name_of(destination);
  if ((destination & 0x80) != 0) request.destination = "mc_" + request.destination;
  request.topic = "topic";
  request.priority = static_cast<Priority>(operands.u8() % 4);
  request.payload.assign(operands.u16() % kLargestPayload, destination);
  if (!robot.open.insert(robot.engine->send(std::move(request), now_)).second) broken("a send id was given twice");
}

void PairOfEngines::flood(Operands& operands) {
  Robot& robot = robots_[operands.u8() % 2];
  BroadcastRequest request;
  request.topic = "topic";
  request.hop_limit = operands.u8();
  request.payload.assign(operands.u8() * std::size_t{8}, 'x');
  if (!robot.open.insert(robot.engine->broadcast(std::move(request), now_)).second) {
    broken("a send id was given twice");
  }
}

std::string PairOfEngines::name_of(std::uint8_t choice) const {
  return "robot_" + std::to_string(choice % (2 + kStrangers));
}

void PairOfEngines::advance(Time duration) {
  const Time end = now_ + duration;
  played_ += duration;
  settle();
  for (;;) {
    const Time next = std::min(robots_[0].engine->next_deadline(), robots_[1].engine->next_deadline());
    if (next > end) break;
    now_ = std::max(now_, next);
    settle();
  }
  now_ = std::max(now_, end);
}

void PairOfEngines::settle() {
  int polls = 0;
  for (std::size_t robot = 0; robot < 2; ++robot) {
    while (robots_[robot].engine->next_deadline() <= now_ || !air_.empty()) {
      if (++polls > kMostPolls) broken("the engines ask for polls without end");
      // Each exchange takes a little time, as on the air: neither acknowledges what has not been sent yet.
      now_ += Time(20us);
      poll(0);
      poll(1);
      std::deque<Frame> arriving;
      arriving.swap(air_);
      for (const Frame& frame : arriving) {
        if (static_cast<int>(random_.next() % 256) < loss_) continue;
        robots_[frame.source == address(0) ? 1 : 0].engine->receive(frame, now_);
      }
    }
  }
}

void PairOfEngines::poll(std::size_t robot) {
  for (Frame& frame : robots_[robot].engine->poll(now_)) {
    if (frame.bytes.size() > kMtu) broken("a frame of " + std::to_string(frame.bytes.size()) + " octets");
    if (frame.destination == wire::kEverybody || frame.destination == address(1 - robot)) {
      air_.push_back(std::move(frame));
    }
  }
  take_events(robots_[robot]);
}

void PairOfEngines::take_events(Robot& robot) {
  while (std::optional<Event> event = robot.engine->next_event()) {
    const auto* end = std::get_if<SendFinished>(&*event);
    if (end != nullptr && robot.open.erase(end->id) == 0) broken("a send ended that was not open");
    auto* packet = std::get_if<PacketReceived>(&*event);
    if (packet != nullptr && unpack(*packet) && packet->payload.size() > kLargestPacket)
      broken("a packet is larger than allowed");
  }
}

void PairOfEngines::check(const Robot& robot) const {
  for (const TableFill& table : robot.engine->tables()) {
    if (table.size > table.most) {
      broken("table '" + std::string(table.table) + "' has " + std::to_string(table.size) + " entries, at most " +
             std::to_string(table.most) + " are allowed");
    }
  }
}

void PairOfEngines::finish() {
  loss_ = 0;
  const Time end = now_ + kPatience;
  while (now_ < end && !(robots_[0].open.empty() && robots_[1].open.empty())) advance(10ms);
  for (const Robot& robot : robots_) {
    if (!robot.open.empty()) broken("send " + std::to_string(*robot.open.begin()) + " does not end");
  }
}

}  // namespace adhoc_communication::fuzz
