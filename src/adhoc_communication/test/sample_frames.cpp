// Writes a capture of one frame of each type, an altered and a cut one: sample_frames FILE
#include <iostream>

#include "link/capture_file.hpp"
#include "transport/packet_image.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using wire::FrameType;

constexpr MacAddress kAlice = {2, 0, 0, 0, 0, 1};
constexpr MacAddress kBob = {2, 0, 0, 0, 0, 2};
constexpr MacAddress kCarol = {2, 0, 0, 0, 0, 3};

Bytes image() { return *transport::encode({transport::PacketKind::kUser, 'A', "mc_alice", "greeting", {'h', 'i'}}); }

class Sample {
 public:
  explicit Sample(const std::string& path) : file_(path, 0) {}

  template <typename Message>
  void add(FrameType type, const Message& message, std::uint8_t flags = 0) {
    add(type, to_bytes(message), flags);
  }
  void add(FrameType type, const Bytes& body, std::uint8_t flags = 0) {
    wire::FrameHeader header;
    header.type = type;
    header.flags = flags;
    header.sender = kAlice;
    header.boot_id.fill(0xab);
    header.counter = ++counter_;
    header.next_hop = kBob;
    header.link_sequence = 77;
    write(wire::close_openly(header, body));
  }
  void write(Bytes octets) {
    file_.add({kBob, kAlice, std::move(octets)}, std::chrono::seconds(1'000'000'000) + std::chrono::nanoseconds(++at_));
  }

 private:
  CaptureFile file_;
  std::uint64_t counter_ = 0;
  std::uint64_t at_ = 0;
};

constexpr std::uint16_t kSegmentSize = 64;

/// The first of one, or the second of two.
wire::Data data_segment(std::uint32_t index, Bytes octets) {
  const std::uint32_t total = index * kSegmentSize + static_cast<std::uint32_t>(octets.size());
  return {kAlice, 0xa1, kCarol, 1, true, 2, 9, 8, index, total, kSegmentSize, 0, std::move(octets)};
}

wire::GroupData group_data(Bytes octets, std::uint8_t symbol) {
  const auto total = static_cast<std::uint32_t>(image().size());
  return {kAlice, 0xa1, 2, true, false, false, 1, 5, 31, 30, total, kSegmentSize, 0, symbol, std::move(octets)};
}

void write_samples(const std::string& path) {
  Sample sample(path);
  sample.add(FrameType::kBeacon, wire::Beacon{5, 6, 3, "alice", 2, {{0xb1, 51}}, {{kCarol, 0xc1, 3, 2, "carol"}}, 250});
  sample.add(FrameType::kRouteRequest, wire::RouteRequest{false, false, true, true, true, 1, 7, 20, 42, kCarol, 10,
                                                          "carol", kAlice, 11, 0xa1, "alice"});
  sample.add(FrameType::kRouteReply, wire::RouteReply{false, true, 2, 36, kCarol, 12, 0xc1, "carol", kAlice, 3000},
             wire::kWantsAcknowledgment);
  sample.add(FrameType::kRouteError, wire::RouteError{false, true, {{kCarol, 13}, {kBob, 14}}});
  sample.add(FrameType::kHopAcknowledgment, wire::HopAcknowledgment{0xb1, 99, 1200, 800, 55, 0xff});
  sample.add(FrameType::kData, data_segment(0, image()), wire::kWantsAcknowledgment | wire::kAcknowledgeNow);
  sample.add(FrameType::kData, data_segment(1, Bytes(kSegmentSize, 1)));
  sample.add(FrameType::kTransportAcknowledgment,
             wire::TransportAcknowledgment{
                 kCarol, 0xc1, kAlice, 0xa1, 3, 1, 20, {{21, 1, 4, {0x0f, 0x01}}, {22, 0, 0, {}}}, {{23, 2}}});
  sample.add(FrameType::kBroadcastData, wire::BroadcastData{3, 0, static_cast<std::uint32_t>(image().size()),
                                                            static_cast<std::uint16_t>(image().size()), image()});
  sample.add(FrameType::kFlood, wire::Flood{kAlice, 0xa1, 4, 1, 3, "alice", image()});
  sample.add(FrameType::kGroupActivation, wire::GroupActivation{kAlice, 0xa1, 7, {kBob, kCarol}});
  sample.add(FrameType::kGroupRefusal, wire::GroupRefusal{kAlice, 0xa1, 7, {kCarol}});
  sample.add(FrameType::kGroupData, group_data(image(), 0));
  sample.add(FrameType::kGroupData, group_data({9, 9, 9}, 130));
  sample.add(FrameType::kGroupData, group_data({}, 0));
  sample.add(FrameType::kGroupReport,
             wire::GroupReport{kAlice, 0xa1, 2, 31, 7, 5, true, 98, 1300, 0xc0ffee, 4, {3, 0}});
  sample.add(FrameType::kRouteReplyAcknowledgment, Bytes{});
  wire::GroupData flooded = group_data(image(), 0);
  flooded.report = false;
  flooded.flooded = true;
  sample.add(FrameType::kGroupData, flooded);
  sample.add(FrameType::kGroupReceipts,
             wire::GroupReceipts{{{kAlice, 0xa1, 2, kBob, 32, 0}, {kAlice, 0xa1, 2, kCarol, 31, 1, true}}});

  Bytes sealed;
  wire::Writer writer(sealed);
  write(writer, wire::FrameHeader{FrameType::kData, wire::kSealed, kAlice, {}, 1, kBob, 0});
  sealed.resize(sealed.size() + 30, 0xee);
  sample.write(sealed);

  wire::FrameHeader header;
  header.sender = kAlice;
  Bytes altered = wire::close_openly(header, to_bytes(wire::Beacon{1, 1, 1, "alice", 0, {}, {}, 0}));
  altered.back() ^= 1;
  sample.write(altered);
  sample.write(Bytes(altered.begin(), altered.begin() + 20));
}

}  // namespace
}  // namespace adhoc_communication

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: sample_frames FILE\n";
    return 2;
  }
  adhoc_communication::write_samples(argv[1]);
  return 0;
}
