// make_corpus FOLDER: inputs for the fuzzers below FOLDER, taken from what a small team puts on the air. Those of
// fuzz_sealed are few of fuzz_engine by which the engines take three frames of each type.
#include <adhoc_communication/CMgrRobotUpdate.h>
#include <adhoc_communication/ExpAuction.h>
#include <adhoc_communication/ExpCluster.h>
#include <adhoc_communication/ExpFrontier.h>
#include <adhoc_communication/MmControl.h>
#include <adhoc_communication/MmMapUpdate.h>
#include <adhoc_communication/MmPoint.h>
#include <adhoc_communication/MmRobotPosition.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/OccupancyGrid.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "multicast/groups.hpp"
#include "node/payload.hpp"
#include "operations.hpp"
#include "payloads.hpp"
#include "play.hpp"
#include "relay/definition_md5.hpp"
#include "simulation/team.hpp"
#include "transport/packet_image.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using fuzz::Operation;

constexpr std::size_t kMostOfOneType = 6;
constexpr std::size_t kLongestInput = 600;  ///< of fuzz_engine, as run_fuzz.py lets them be
constexpr std::size_t kStepsBetweenInputs = 16;

class Corpus {
 public:
  explicit Corpus(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void add(const std::string& target, const Bytes& input) {
    const std::filesystem::path folder = folder_ / target;
    std::filesystem::create_directories(folder);
    char name[16];
    std::snprintf(name, sizeof name, "%03zu", count_[target]++);
    std::ofstream file(folder / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
  }
  void add(const std::string& target, std::uint8_t reader, const std::string& text) {
    Bytes input{reader};
    input.insert(input.end(), text.begin(), text.end());
    add(target, input);
  }

 private:
  std::filesystem::path folder_;
  std::map<std::string, std::size_t> count_;
};

/// A team that sends a little of everything; a robot crashes and comes back.
std::vector<Frame> record() {
  MediumOptions medium;
  medium.loss = 0.1;
  Team team(medium, 5);
  EngineOptions options;
  options.max_frame_size = 300;
  team.add_line(4, options);
  std::vector<Frame> frames;
  team.on_transmission = [&](std::size_t, const Frame& frame) { frames.push_back(frame); };
  team.run_for(3s);
  team.send(0, "robot_3", noise(600));
  team.send(3, "mc_robot_3", noise(100));
  team.send(1, "mc_robot_3", text("to the group of another"));
  team.send(2, "", noise(500));
  team.engine(1).broadcast({"topic", 'A', text("flood"), 3}, team.now());
  team.run_for(1s);
  team.kill(2);
  team.send(0, "robot_3", text("the way is cut"));
  team.run_for(3s);
  team.restart(2);
  team.run_for(3s);
  return frames;
}

Bytes body_of(const Frame& frame) { return wire::open_body(frame.bytes)->rest(); }

void add_bodies(Corpus& corpus, const std::vector<Frame>& frames) {
  std::map<std::uint8_t, std::size_t> taken;
  for (std::size_t i = 0; i < frames.size(); i += 7) {
    const std::uint8_t type = frames[i].bytes[1];
    if (++taken[type] > kMostOfOneType) continue;
    // Behind the members and whole frames of fuzz_wire.cpp come the messages of groups.
    Bytes input{static_cast<std::uint8_t>(type < 10 ? type : type + 2)};
    const Bytes body = body_of(frames[i]);
    input.insert(input.end(), body.begin(), body.end());
    corpus.add("fuzz_wire", input);
  }
  Bytes header{0}, whole{11};
  header.insert(header.end(), frames[0].bytes.begin(), frames[0].bytes.begin() + wire::kHeaderSize);
  whole.insert(whole.end(), frames[0].bytes.begin(), frames[0].bytes.end());
  corpus.add("fuzz_wire", header);
  corpus.add("fuzz_wire", whole);
  Bytes members{10};
  const Bytes list = multicast::encode_members({"robot_0", "robot_1"});
  members.insert(members.end(), list.begin(), list.end());
  corpus.add("fuzz_wire", members);
}

void add_images(Corpus& corpus) {
  using transport::PacketKind;
  for (const std::size_t size : {0, 1, 100, 1000}) {
    corpus.add("fuzz_packet_image", *transport::encode({PacketKind::kUser, 'A', "", "topic", noise(size)}));
    corpus.add("fuzz_packet_image", *transport::encode({PacketKind::kUser, 'M', "mc_robot_1", "map", map_like(size)}));
  }
  for (int kind = 1; kind <= 4; ++kind) {
    corpus.add("fuzz_packet_image", *transport::encode({static_cast<PacketKind>(kind), 0, "mc_robot_0", "", {}}));
  }
}

void add_texts(Corpus& corpus) {
  corpus.add("fuzz_text", 0, "# of the team\n" + std::string(64, 'a') + "\n\n" + std::string(64, '7') + "\r\n");
  corpus.add("fuzz_text", 1, "02:00:00:00:00:01");
  corpus.add("fuzz_text", 2, "* /map,/robot_?/map /rosout /clock [a-z]*");
  corpus.add("fuzz_text", 3,
             "position robot_1 3 -4.5\nrange 12\nloss 0.1\nlink robot_0 robot_1 1\ndown robot_1\nup robot_1\n");
}

/// A definition that uses another one, with fields of all sorts.
std::string nested_definition() {
  return "# a comment\nuint8 ONE = 1\nstd_msgs/Header header\nPart[] parts\nfloat64[9] k\nstring TEXT=a # b\n" +
         std::string(80, '=') + "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n" +
         std::string(80, '=') + "\nMSG: pkg/Part\nint16[] values\nduration age\n";
}

void add_messages(Corpus& corpus) {
  for (const std::string& definition : {std::string("float64 x\n"), nested_definition(), std::string()}) {
    const SerializedMessage message{"pkg/Whole", md5_of_definition("pkg/Whole", definition), definition, text("octets"),
                                    false};
    for (const std::uint8_t reader : {0, 1, 2, 3}) {
      const Bytes payload = reader % 2 == 0 ? encode_any_message(message) : encode_message_by_type(message);
      corpus.add("fuzz_message", reader, std::string(payload.begin(), payload.end()));
    }
    corpus.add("fuzz_message", 4, "pkg/Whole\n" + definition);
  }
}

template <typename Message>
void add_payload(Corpus& corpus, PayloadType type, const Message& message) {
  const Bytes payload = serialize(message);
  corpus.add("fuzz_payload", static_cast<std::uint8_t>(type), std::string(payload.begin(), payload.end()));
}

void add_payloads(Corpus& corpus) {
  nav_msgs::OccupancyGrid map;
  map.header.frame_id = "map";
  map.info.resolution = 0.05F;
  map.info.width = 4;
  map.info.height = 2;
  map.data = {0, 100, -1, 0, 100, -1, 0, 100};
  MmRobotPosition position;
  position.src_robot = "robot_0";
  position.position.header.frame_id = "map";
  position.position.pose.position.x = 1.5;
  MmMapUpdate update;
  update.map = map;
  MmControl control;
  control.update_numbers = {3, 1, 2};
  ExpFrontier frontier;
  frontier.frontier_element.resize(2);
  ExpCluster cluster;
  cluster.ids_contained.resize(3);
  ExpAuction auction;
  auction.available_clusters.resize(2);
  corpus.add("fuzz_payload", static_cast<std::uint8_t>(PayloadType::kString), "hello");
  add_payload(corpus, PayloadType::kMap, map);
  add_payload(corpus, PayloadType::kPosition, position);
  add_payload(corpus, PayloadType::kPoint, MmPoint());
  add_payload(corpus, PayloadType::kMapUpdate, update);
  add_payload(corpus, PayloadType::kControl, control);
  add_payload(corpus, PayloadType::kFrontier, frontier);
  add_payload(corpus, PayloadType::kCluster, cluster);
  add_payload(corpus, PayloadType::kAuction, auction);
  add_payload(corpus, PayloadType::kTwist, geometry_msgs::Twist());
  add_payload(corpus, PayloadType::kQuaternion, geometry_msgs::Quaternion());
  add_payload(corpus, PayloadType::kRobotUpdate, CMgrRobotUpdate());
  const Bytes any = encode_any_message({"pkg/Type", md5_of_definition("pkg/Type", ""), "", text("octets"), false});
  corpus.add("fuzz_payload", static_cast<std::uint8_t>(PayloadType::kAnyMessage), std::string(any.begin(), any.end()));
}

void append(Bytes& input, Operation operation, std::initializer_list<std::uint8_t> operands) {
  input.push_back(static_cast<std::uint8_t>(operation));
  input.insert(input.end(), operands);
}

/// What happens to robot 0 of a team in a line, as operations of the fuzzer. Its robot 1, which is an engine, is out of
/// reach of this team; the others are strangers there.
class LifeOfARobot {
 public:
  struct Step {
    Time at;
    std::size_t beacon_of;  ///< a stranger; 0: anything else
    Bytes operation;
  };

  /// `place`: of robot 0 in the line of four. Without repetition on each hop, replies of routes are acknowledged.
  LifeOfARobot(std::size_t place, bool hops_repeat) : team_(medium(), 5) {
    EngineOptions options;
    options.max_frame_size = 300;
    if (!hops_repeat) options.num_link_retrans = 0;
    std::vector<std::size_t> line = {2, 3, 4};
    line.insert(line.begin() + static_cast<std::ptrdiff_t>(place), 0);
    for (std::size_t robot = 0; robot < line.size() + 1; ++robot) {
      const auto at = std::find(line.begin(), line.end(), robot);
      team_.add(options, at == line.end() ? kFarAway : kSpacing * static_cast<double>(at - line.begin()));
    }
    team_.on_frame = [this](Medium::Node node, const Frame& frame) { hear(node, frame); };
  }

  std::vector<Step> live() {
    team_.run_for(3s);
    send(0, 4, 0, 600);
    send(4, 0, 0, 600);
    send(0, 0, kGroup, 700);
    send(3, 3, kGroup, 300);
    send(2, 4, kGroup, 100);
    team_.send(3, "", noise(500));
    team_.engine(2).broadcast({"topic", 'A', text("flood"), 3}, team_.now());
    team_.run_for(1s);
    team_.kill(3);
    send(0, 4, 0, 20);
    team_.run_for(2s);
    team_.restart(3);
    send(2, 0, kGroup, 900);
    team_.run_for(3s);
    return std::move(steps_);
  }

 private:
  static constexpr std::uint8_t kGroup = 0x80;
  static constexpr double kSpacing = 8.0, kFarAway = 1000.0;

  static MediumOptions medium() {
    MediumOptions medium;
    medium.loss = 0.1;
    return medium;
  }

  void send(std::size_t from, std::size_t to, std::uint8_t flags, std::uint16_t size) {
    team_.send(from, (flags == kGroup ? "mc_" : "") + Team::name(to), noise(size));
    if (from != 0) return;
    Bytes operation;
    append(operation, Operation::kSend,
           {0, static_cast<std::uint8_t>(flags | to), 1, static_cast<std::uint8_t>(size >> 8),
            static_cast<std::uint8_t>(size & 0xff)});
    steps_.push_back({team_.now(), 0, operation});
  }

  void hear(Medium::Node node, const Frame& frame) {
    if (node != 0 || (frame.destination != wire::kEverybody && frame.destination != Team::address(0))) return;
    const Bytes body = with_boots_of_the_fuzzer(body_of(frame));
    if (body.size() > 255) return;
    const std::size_t sender = frame.source[5];
    const bool everybody = frame.destination == wire::kEverybody, later_run = team_.boots(sender) > 1;
    Bytes operation;
    append(operation, Operation::kFrame,
           {0, static_cast<std::uint8_t>(sender), static_cast<std::uint8_t>(frame.bytes[1] - 1),
            static_cast<std::uint8_t>(frame.bytes[2] | (everybody ? 0x40 : 0) | (later_run ? 0x80 : 0)),
            frame.bytes[wire::kHeaderSize - 1], static_cast<std::uint8_t>(body.size())});
    operation.insert(operation.end(), body.begin(), body.end());
    const bool beacon = frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kBeacon);
    steps_.push_back({team_.now(), beacon ? sender : 0, operation});
  }

  /// Bodies name runs of robots; those of this team are not those of the fuzzer.
  Bytes with_boots_of_the_fuzzer(Bytes body) {
    for (std::size_t robot = 0; robot < team_.size(); ++robot) {
      boots_[team_.boot_id(robot)] = fuzz::PairOfEngines::boot_id(robot, robot == 0 || team_.boots(robot) == 1 ? 1 : 0);
    }
    for (const auto& [team, fuzzer] : boots_) {
      for (auto at = body.begin();;) {
        at = std::search(at, body.end(), team.begin(), team.begin() + kBootTag);
        if (at == body.end()) break;
        at = std::copy_n(fuzzer.begin(), kBootTag, at);
      }
    }
    return body;
  }

  static constexpr std::size_t kBootTag = sizeof(wire::BootTag);
  Team team_;
  std::map<BootId, BootId> boots_;
  std::vector<Step> steps_;
};

/// One input: robot 0 learns who is there, then steps from `first` on, at their pace, as many as there is room for.
Bytes play_from(const std::vector<LifeOfARobot::Step>& steps, std::size_t first) {
  Bytes input;
  std::size_t operations = 0;
  for (std::uint8_t stranger = 2; stranger <= 4; ++stranger) {
    const auto beacon =
        std::find_if(steps.begin(), steps.end(), [&](const auto& step) { return step.beacon_of == stranger; });
    if (beacon == steps.end()) continue;
    input.insert(input.end(), beacon->operation.begin(), beacon->operation.end());
    ++operations;
  }
  Time at = steps[first].at;
  for (std::size_t i = first; i < steps.size() && operations + 2 <= fuzz::kMostOperations; ++i) {
    if (input.size() + 2 + steps[i].operation.size() > kLongestInput) break;
    const auto gap = std::min<Time::rep>((steps[i].at - at) / Time(1ms), 100);
    if (gap > 0) {
      append(input, Operation::kAdvance, {static_cast<std::uint8_t>(gap)});
      ++operations;
    }
    at = steps[i].at;
    input.insert(input.end(), steps[i].operation.begin(), steps[i].operation.end());
    ++operations;
  }
  return input;
}

void add_lives(Corpus& corpus) {
  for (std::size_t place = 0; place < 4; ++place) {
    for (const bool hops_repeat : {true, false}) {
      const std::vector<LifeOfARobot::Step> steps = LifeOfARobot(place, hops_repeat).live();
      for (std::size_t first = 0; first < steps.size(); first += kStepsBetweenInputs) {
        corpus.add("fuzz_engine", play_from(steps, first));
      }
    }
  }
}

void add_operations(Corpus& corpus) {
  Bytes input;
  append(input, Operation::kAdvance, {200});
  append(input, Operation::kSend, {0, 1, 2, 0x10, 0});
  append(input, Operation::kSend, {1, 0x80, 1, 0, 9});
  append(input, Operation::kSend, {0, 0x40, 3, 8, 0});
  append(input, Operation::kLose, {60});
  append(input, Operation::kFlood, {1, 3, 4});
  append(input, Operation::kAdvance, {100});
  append(input, Operation::kLeave, {1, 0});
  append(input, Operation::kRestart, {0});
  append(input, Operation::kAdvance, {250});
  append(input, Operation::kJoin, {1, 0});
  append(input, Operation::kJump, {60});
  append(input, Operation::kSend, {1, 5, 2, 0, 1});
  corpus.add("fuzz_engine", input);
}

}  // namespace
}  // namespace adhoc_communication

int main(int argc, char** argv) {
  using namespace adhoc_communication;
  if (argc != 2) {
    std::fprintf(stderr, "make_corpus FOLDER\n");
    return 2;
  }
  Corpus corpus(argv[1]);
  const std::vector<Frame> frames = record();
  add_bodies(corpus, frames);
  add_images(corpus);
  add_texts(corpus);
  add_messages(corpus);
  add_payloads(corpus);
  add_lives(corpus);
  add_operations(corpus);
}
