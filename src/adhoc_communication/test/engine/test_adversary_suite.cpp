// What an adversary does for seconds on end to a team that works.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adversary_suite.hpp"
#include "multicast/group_packet.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using transport::PacketKind;

constexpr std::size_t kRobots = AdversarySuite::kRobots;

std::size_t largest() { return AdversarySuite::largest(); }

/// Each robot in range of the next only, so that what the first and the last one send to each other takes two hops.
class AdversarySuiteOnALine : public AdversarySuite {
 protected:
  AdversarySuiteOnALine() : AdversarySuite(8.0) {}
};

INSTANTIATE_TEST_SUITE_P(Open, AdversarySuite, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Sealed, AdversarySuite, testing::Values(true));
INSTANTIATE_TEST_SUITE_P(Open, AdversarySuiteOnALine, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Sealed, AdversarySuiteOnALine, testing::Values(true));

std::vector<wire::Rumor> rumors_of_strangers(std::size_t first, std::size_t count, std::uint32_t alive) {
  std::vector<wire::Rumor> rumors;
  for (std::size_t i = 0; i < count; ++i) {
    const Host host = make_host(first + i);
    rumors.push_back({host.address, host.boot(), alive, 1, host.name});
  }
  return rumors;
}

/// One segment each of packets of the largest size, of ten robots that do not exist.
TEST_P(AdversarySuite, ForgedSizesBlockNoReassembly) {
  Insider forger = insider();
  std::uint32_t packet = 0;
  withstand([&](int step, std::size_t robot) {
    if (step % 20 == 0) forger.prove(robot, rumors_of_strangers(20, 10, static_cast<std::uint32_t>(step + 1)));
    wire::Data data = data_for(forger.robot(robot), make_host(20 + static_cast<std::size_t>(step) % 10), ++packet);
    data.stream = static_cast<std::uint8_t>(step % 4);
    data.total = static_cast<std::uint32_t>(largest());
    data.segment_size = 1400;
    data.octets.assign(1400, 0);
    data.index = static_cast<std::uint32_t>(step) % 700;
    forger.say(robot, data);
    wire::BroadcastData broadcast{packet, 0, data.total, 1400, Bytes(1400)};
    forger.say(robot, wire::FrameType::kBroadcastData, wire::to_bytes(broadcast));
  });
}

/// All that a former run of a robot has sent, again and again.
TEST_P(AdversarySuite, ReplayedRunsChangeNothing) {
  std::vector<Frame> recorded;
  team_.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (robot == 1) recorded.push_back(frame);
  };
  for (int i = 0; i < 20; ++i) {
    team_.send(1, i % 2 == 0 ? "robot_0" : "robot_2", noise(5'000));
    team_.run_for(100ms);
  }
  team_.on_transmission = nullptr;
  team_.restart(1);
  team_.run_for(2s);
  ASSERT_GT(recorded.size(), 100u);
  forget();
  std::size_t next = 0;
  withstand([&](int, std::size_t robot) {
    for (int i = 0; i < 3; ++i) team_.engine(robot).receive(recorded[next++ % recorded.size()], team_.now());
  });
}

/// Requests, replies, packets, acknowledgments, floods, places in trees and rumours of runs that do not exist.
TEST_P(AdversarySuite, DisplacedRunsAreNotBelieved) {
  Insider liar = insider();
  withstand([&](int step, std::size_t robot) {
    if (step % 20 == 0) liar.prove(robot);
    Host displaced = liar.robot((robot + 1 + static_cast<std::size_t>(step) % 2) % kRobots);
    displaced.boot_id = {0x99, static_cast<std::uint8_t>(step >> 8), static_cast<std::uint8_t>(step)};
    displaced.sequence = 1'000'000 + static_cast<std::uint32_t>(step);
    switch (step % 7) {
      case 0:
        return liar.say(robot, request_for(make_host(8), displaced, static_cast<std::uint32_t>(step)));
      case 1:
        return liar.say(robot, reply_about(displaced, make_host(8)));
      case 2:
        return liar.say(robot, data_for(liar.robot(robot), displaced));
      case 3:
        return liar.say(robot, acknowledgment_of(displaced, liar.robot(robot), 1'000'000));
      case 4: {
        wire::Flood flood;
        flood.source = displaced.address;
        flood.source_boot = displaced.boot();
        flood.source_name = displaced.name;
        flood.id = static_cast<std::uint32_t>(step);
        return liar.say(robot, wire::FrameType::kFlood, wire::to_bytes(flood));
      }
      case 5:
        return liar.say(robot, wire::GroupActivation{displaced.address, displaced.boot(), 1, {Team::address(robot)}});
      default:
        return liar.prove(robot, {{displaced.address, displaced.boot(), 1'000'000, 1, displaced.name}});
    }
  });
}

/// A megabyte of zeros in a hundred octets: as packets, floods, broadcasts, lists of members and copies.
TEST_P(AdversarySuite, BombsTakeLittle) {
  Insider bomber = insider();
  const auto bomb = [](PacketKind kind, const std::string& group) {
    return transport::encode({kind, kind == PacketKind::kUser ? std::uint8_t{'A'} : std::uint8_t{0}, group,
                              kind == PacketKind::kUser ? "topic" : "", Bytes(largest() - 100)});
  };
  const std::vector<transport::Image> bombs = {
      bomb(PacketKind::kUser, ""), bomb(PacketKind::kGroupMembers, "mc_host_5"),
      bomb(PacketKind::kGroupCopy, "mc_host_5"), bomb(PacketKind::kGroupJoin, "mc_robot_0")};
  std::vector<std::uint32_t> packets(kRobots, 0);
  withstand([&](int step, std::size_t robot) {
    if (step % 20 == 0) bomber.prove(robot);
    const transport::Image& image = bombs[static_cast<std::size_t>(step) % bombs.size()];
    ASSERT_LT(image->size(), 1400u);
    wire::Data data = data_for(bomber.robot(robot), bomber.host(), ++packets[robot]);
    data.total = static_cast<std::uint32_t>(image->size());
    data.octets = *image;
    bomber.say(robot, data);
    wire::Flood flood;
    flood.source = bomber.host().address;
    flood.source_boot = bomber.host().boot();
    flood.source_name = bomber.host().name;
    flood.id = static_cast<std::uint32_t>(step);
    flood.image = *image;
    bomber.say(robot, wire::FrameType::kFlood, wire::to_bytes(flood));
    team_.received(robot).clear();
  });
  EXPECT_GE(team_.engine(0).statistics().frames_dropped.malformed, static_cast<std::uint64_t>(kSteps))
      << "every flood and the words on groups";
}

/// Beacons of a thousand robots that do not hear the team: in a sealed team they are to prove themselves, in an open
/// one they are neighbours. A robot that starts meanwhile is known all the same.
TEST_P(AdversarySuite, CandidateFloodsKeepNoNewcomerOut) {
  std::deque<Insider> strangers;
  for (std::size_t i = 0; i < 1000; ++i) strangers.emplace_back(team_, make_host(100 + i), options_.keys);
  std::size_t next = 0;
  withstand([&](int step, std::size_t robot) {
    for (int i = 0; i < 2; ++i) {
      Insider& stranger = strangers[next++ % strangers.size()];
      wire::Beacon beacon;
      beacon.name = stranger.host().name;
      beacon.alive = 1;
      stranger.say(robot, beacon);
    }
    if (step == 300 && robot == 0) team_.add(options_);
  });
  for (std::size_t robot = 0; robot < kRobots; ++robot) {
    const std::vector<std::string> neighbors = team_.engine(robot).neighbors();
    EXPECT_NE(std::find(neighbors.begin(), neighbors.end(), "robot_3"), neighbors.end()) << Team::name(robot);
  }
}

/// He joins, acknowledges nothing, claims that other trees hold, refuses what is not his, and gives out places in trees
/// of others. Those that are members all the time get every packet, in order.
TEST_P(AdversarySuite, HostileMembersHoldUpNobody) {
  Insider member = insider();
  member.prove(0);
  wire::Data join = data_for(member.robot(0), member.host(), 1);
  const transport::Image image = transport::encode({PacketKind::kGroupJoin, 0, "mc_robot_0", {}, {}});
  join.stream = 0;
  join.total = static_cast<std::uint32_t>(image->size());
  join.octets = *image;
  member.say(0, join);
  team_.run_for(20ms);
  ASSERT_EQ(team_.engine(0).group_state("mc_robot_0").members.size(), kRobots);
  const wire::BootTag root_boot = wire::boot_tag(team_.boot_id(0));
  std::vector<SendId> sends;
  withstand([&](int step, std::size_t robot) {
    if (step % 20 == 0) member.prove(robot);
    if (robot == 0 && step % 100 == 0) sends.push_back(team_.send(0, "mc_robot_0", noise(20'000)));
    wire::GroupReport report;
    report.root = Team::address(0);
    report.root_boot = root_boot;
    report.stream = static_cast<std::uint8_t>(Priority::kNormal);
    report.packet = static_cast<std::uint32_t>(step / 100 + 1);
    report.epoch = static_cast<std::uint32_t>(step);
    report.coverage = 0x1234;
    report.complete = step % 3 == 0;
    member.say(robot, report);
    member.say(robot, wire::GroupRefusal{Team::address(0),
                                         root_boot,
                                         static_cast<std::uint32_t>(step % 10),
                                         {Team::address(1), Team::address(2), member.host().address}});
    member.say(robot, wire::GroupActivation{Team::address(0),
                                            root_boot,
                                            1000 + static_cast<std::uint32_t>(step),
                                            {Team::address(robot), Team::address((robot + 1) % kRobots)}});
  });
  ASSERT_EQ(sends.size(), 5u);
  ASSERT_TRUE(team_.run_until_done([&] { return team_.finished(0, sends.back()) != nullptr; }, 60s));
  for (std::size_t robot = 1; robot < kRobots; ++robot) {
    std::size_t packets = 0;
    for (const Team::Received& received : team_.received(robot)) packets += received.packet.group == "mc_robot_0";
    EXPECT_EQ(packets, sends.size()) << Team::name(robot);
  }
  for (const SendId id : sends) {
    const std::string& reason = team_.finished(0, id)->reason;
    EXPECT_EQ(reason.find("robot_"), std::string::npos) << reason;
  }
}

/// Packets of the largest size, of several sources, each a segment after the other.
class Hoarders {
 public:
  Hoarders(Team& team, const std::vector<TeamKey>& keys, std::size_t first_host, std::size_t sources,
           std::size_t packets_each)
      : next_(sources * packets_each) {
    for (std::size_t i = 0; i < sources; ++i) sources_.emplace_back(team, make_host(first_host + i), keys);
  }
  std::deque<Insider>& sources() { return sources_; }
  /// The next segment of the next packet; of no packet the last one.
  void go_on(std::size_t robot) {
    const std::size_t number = turn_++ % next_.size();
    Insider& source = sources_[number % sources_.size()];
    const auto packet = static_cast<std::uint32_t>(1 + number / sources_.size());
    wire::Data data = data_for(source.robot(robot), source.host(), packet);
    data.stream = 2;
    data.base = 1;
    data.total = static_cast<std::uint32_t>(largest());
    data.segment_size = 1400;
    if ((next_[number] + 1) * std::size_t{1400} >= data.total) return;
    data.index = next_[number]++;
    data.octets.assign(1400, 0);
    source.say(robot, data);
  }

 private:
  std::deque<Insider> sources_;
  std::vector<std::uint32_t> next_;  ///< by packet: the index of its next segment
  std::size_t turn_ = 0;
};

/// Two robots held all the room with two packets each that never stood still.
class Drips {
 public:
  Drips(Team& team, const std::vector<TeamKey>& keys) {
    for (std::size_t robot = 0; robot < kRobots; ++robot) at_.emplace_back(team, keys, 5 + 2 * robot, 2, 2);
  }
  void operator()(int step, std::size_t robot) {
    if (step % 20 == 0) {
      for (Insider& source : at_[robot].sources()) source.prove(robot);
    }
    if (step % 2 == 0) at_[robot].go_on(robot);
  }

 private:
  std::deque<Hoarders> at_;
};

constexpr Time kBeforeTheyStall = 1s;

TEST_P(AdversarySuite, SlowDripsHoldNoRoom) {
  Drips drips(team_, options_.keys);
  withstand([&](int step, std::size_t robot) { drips(step, robot); }, kBeforeTheyStall);
}

TEST_P(AdversarySuiteOnALine, SlowDripsHoldNoRoom) {
  Drips drips(team_, options_.keys);
  withstand([&](int step, std::size_t robot) { drips(step, robot); }, kBeforeTheyStall);
}

/// A large packet gets room, too: each of the two gives up one of its.
TEST_P(AdversarySuiteOnALine, SlowDripsKeepNoLargePacketOut) {
  Drips drips(team_, options_.keys);
  SendId id = 0;
  for (int step = 0; step < kSteps; ++step) {
    for (std::size_t robot = 0; robot < kRobots; ++robot) drips(step, robot);
    if (step == 50) id = team_.send(0, "robot_2", noise(900'000));
    team_.run_for(kStep);
    expect_bounds();
  }
  expect_delivered(0, id);
}

/// All the room at one robot, really filled; what it takes is measured.
TEST_P(AdversarySuite, FilledRoomKeepsNobodyOut) {
  Hoarders hoarders(team_, options_.keys, 5, 4, 1);
  const std::size_t frames_a_step = 4 * largest() / 1400 / (kSteps / 2) + 1;
  withstand([&](int step, std::size_t robot) {
    if (robot != 0) return;
    if (step % 20 == 0) {
      for (Insider& source : hoarders.sources()) source.prove(robot);
    }
    for (std::size_t i = 0; i < frames_a_step; ++i) hoarders.go_on(robot);
    if (step == kSteps - 1) EXPECT_GT(team_.engine(0).queues().stream_octets, 39 * largest() / 10);
  });
}

/// A root whose packets have arrived, which does not go on and asks about them again and again.
class StandingRoot {
 public:
  StandingRoot(Team& team, const std::vector<TeamKey>& keys) : team_(team), root_(team, make_host(5), keys) {
    const std::string group = "mc_" + root_.host().name;
    const std::size_t total = transport::image_size(group, "topic", largest() - 100);
    packet_ = std::make_unique<multicast::GroupPacket>(static_cast<std::uint32_t>(total), 1400);
    // All behind the beginning is zeros, so that the packet need not be held here.
    beginning_ = *transport::image_of({PacketKind::kUser, 'A', group, "topic", Bytes(largest() - 100)});
    beginning_.resize(1400);
    beginning_.shrink_to_fit();
    team_.on_transmission = [this](std::size_t robot, const Frame& frame) { remember(robot, frame); };
  }
  ~StandingRoot() { team_.on_transmission = nullptr; }

  void begin() {
    root_.prove(0);
    run_for(200ms);
    root_.prove(0);
    root_.say(0, wire::GroupActivation{root_.host().address, root_.host().boot(), 1, {Team::address(0)}});
    run_for(20ms);
  }
  void send(std::uint32_t number) {
    std::size_t sent = 0;
    for (std::size_t block = 0; block < packet_->blocks().size(); ++block) {
      for (int symbol = 0; symbol < packet_->blocks()[block].frames(); ++symbol) {
        wire::GroupData data = frame(number);
        data.block = static_cast<std::uint16_t>(block);
        data.symbol = static_cast<std::uint8_t>(symbol);
        data.octets = sent == 0 ? beginning_ : Bytes(std::min<std::size_t>(1400, data.total - 1400 * sent));
        root_.say(0, data);
        if (++sent % 50 == 0) run_for(5ms);
      }
    }
    root_.prove(0);
    run_for(20ms);
  }
  void ask(std::uint32_t number) {
    wire::GroupData question = frame(number);
    question.report = true;
    root_.say(0, question);
  }
  void prove() { root_.prove(0); }
  void run_for(Time duration) {
    for (const Time end = team_.now() + duration; team_.now() < end;) {
      team_.run_for(std::min<Time>(5ms, end - team_.now()));
      acknowledge();
    }
  }

 private:
  wire::GroupData frame(std::uint32_t number) const {
    wire::GroupData data;
    data.root = root_.host().address;
    data.root_boot = root_.host().boot();
    data.stream = 2;
    data.packet = number;
    data.base = 1;
    data.total = packet_->total();
    data.segment_size = packet_->segment_size();
    return data;
  }
  void remember(std::size_t robot, const Frame& frame) {
    wire::Reader reader(frame.bytes);
    const auto header = wire::read_header(reader);
    const bool wanted = robot == 0 && header && header->next_hop == root_.host().address &&
                        (header->flags & wire::kWantsAcknowledgment) != 0;
    if (wanted) owed_.push_back(*header);
  }
  void acknowledge() {
    for (const wire::FrameHeader& header : std::exchange(owed_, {})) {
      wire::HopAcknowledgment acknowledgment;
      acknowledgment.boot = wire::boot_tag(team_.boot_id(0));
      acknowledgment.newest_counter = header.counter;
      acknowledgment.highest = header.link_sequence;
      acknowledgment.received = ~std::uint64_t{0};
      root_.say(0, acknowledgment);
    }
  }

  Team& team_;
  Insider root_;
  std::unique_ptr<multicast::GroupPacket> packet_;  ///< how it is cut
  Bytes beginning_;                                 ///< its first frame
  std::vector<wire::FrameHeader> owed_;
};

TEST_P(AdversarySuite, DeliveredGroupPacketsHoldNoRoom) {
  StandingRoot root(team_, options_.keys);
  root.begin();
  for (std::uint32_t number = 1; number <= 4; ++number) {
    root.send(number);
    ASSERT_EQ(team_.received(0).size(), 1u);
    forget();
  }
  SendId id = 0;
  for (int round = 0; round < 50; ++round) {
    root.prove();
    for (std::uint32_t number = 1; number <= 4; ++number) root.ask(number);
    if (round == 10) id = team_.send(1, "robot_0", noise(900'000));
    root.run_for(100ms);
    expect_bounds();
  }
  expect_delivered(1, id);
}

}  // namespace
}  // namespace adhoc_communication
