// make_corpus FOLDER: inputs for the fuzzers below FOLDER, taken from what a small team puts on the air.
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "multicast/groups.hpp"
#include "operations.hpp"
#include "pair_of_engines.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"
#include "transport/packet_image.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using fuzz::Operation;

constexpr std::size_t kMostOfOneType = 6;
constexpr std::size_t kFramesInOneInput = 12;

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

void append(Bytes& input, Operation operation, std::initializer_list<std::uint8_t> operands) {
  input.push_back(static_cast<std::uint8_t>(operation));
  input.insert(input.end(), operands);
}

/// The frame as robot 0 of the fuzzer would hear it.
void append_frame(Bytes& input, const Frame& frame) {
  const Bytes body = body_of(frame);
  if (body.size() > 255) return;
  const bool everybody = frame.destination == wire::kEverybody;
  const auto sender = static_cast<std::uint8_t>(1 + frame.source[5]);
  append(input, Operation::kFrame,
         {0, sender, static_cast<std::uint8_t>(frame.bytes[1] - 1),
          static_cast<std::uint8_t>(frame.bytes[2] | (everybody ? 0x40 : 0)), frame.bytes[wire::kHeaderSize - 1],
          static_cast<std::uint8_t>(body.size())});
  input.insert(input.end(), body.begin(), body.end());
}

void add_operations(Corpus& corpus, const std::vector<Frame>& frames) {
  for (std::size_t first = 0; first + kFramesInOneInput < frames.size() && first < 1000; first += 37) {
    Bytes input;
    for (std::size_t i = 0; i < kFramesInOneInput; ++i) {
      append_frame(input, frames[first + i]);
      if (i % 4 == 3) append(input, Operation::kAdvance, {50});
    }
    corpus.add("fuzz_engine", input);
  }
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
  add_operations(corpus, frames);
}
