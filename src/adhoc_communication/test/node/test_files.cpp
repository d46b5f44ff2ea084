// Capture and logs: whole records, bounded size, a full disk loses rows and nothing else.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <stdexcept>
#include <thread>

#include "link/capture_link.hpp"
#include "link/ethernet.hpp"
#include "node/csv_file.hpp"
#include "node/network_logs.hpp"
#include "node/record_log.hpp"
#include "node/record_rows.hpp"

namespace adhoc_communication {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class Files : public testing::Test {
 protected:
  Files() {
    char name[] = "/tmp/adhoc_files_XXXXXX";
    folder = mkdtemp(name);
  }
  ~Files() override { fs::remove_all(folder); }

  fs::path folder;
};

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct CapturedFrame {
  std::uint32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::string octets;
};

/// Fails the test unless the file is a whole pcap file.
std::vector<CapturedFrame> records(const fs::path& path) {
  const std::string octets = content(path);
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, octets.data() + at, sizeof value);
    return value;
  };
  std::vector<CapturedFrame> result;
  if (octets.size() < 24) {
    ADD_FAILURE() << "no file header";
    return result;
  }
  EXPECT_EQ(number(0), 0xa1b23c4du);
  EXPECT_EQ(number(20), 1u);
  std::size_t at = 24;
  while (at + 16 <= octets.size()) {
    const std::uint32_t size = number(at + 8);
    EXPECT_EQ(size, number(at + 12));
    if (at + 16 + size > octets.size()) break;
    result.push_back({number(at), number(at + 4), octets.substr(at + 16, size)});
    at += 16 + size;
  }
  EXPECT_EQ(at, octets.size()) << "the last record is cut";
  return result;
}

Frame frame(std::size_t size, std::uint8_t fill = 0) {
  return {{2, 0, 0, 0, 0, 1}, {2, 0, 0, 0, 0, 2}, Bytes(size, fill)};
}

TEST_F(Files, CaptureHoldsFramesWithEthernetHeaderAndNanoseconds) {
  {
    CaptureFile capture(folder / "a.pcap", 0);
    capture.add(frame(100, 7), std::chrono::nanoseconds(5'000'000'123));
    capture.add(frame(3), std::chrono::nanoseconds(6'000'000'000));
  }
  const auto found = records(folder / "a.pcap");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].seconds, 5u);
  EXPECT_EQ(found[0].nanoseconds, 123u);
  const Bytes expected = to_wire(frame(100, 7));
  EXPECT_EQ(found[0].octets, std::string(expected.begin(), expected.end()));
  EXPECT_EQ(found[1].octets.size(), 3 + kEthernetHeaderSize);
}

/// The writer has a thread of its own.
bool reaches(const std::function<std::uint64_t()>& counter, std::uint64_t value) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (counter() < value && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  return counter() == value;
}

TEST_F(Files, CaptureIsBoundedAndKeepsTheLatest) {
  constexpr std::uint64_t kMost = 20'000;
  const fs::path path = folder / "a.pcap";
  const fs::path old = folder / "a.pcap.old";
  CaptureFile capture(path, kMost);
  for (std::uint8_t i = 0; i < 200; ++i) {
    capture.add(frame(500, i), std::chrono::nanoseconds(i));
    ASSERT_TRUE(reaches([&] { return capture.frames_written(); }, i + 1u));
    ASSERT_LE(fs::file_size(path) + (fs::exists(old) ? fs::file_size(old) : 0), kMost);
  }
  EXPECT_EQ(capture.frames_lost(), 0u);
  std::vector<CapturedFrame> all = records(old);
  for (const CapturedFrame& record : records(path)) all.push_back(record);
  EXPECT_GE(all.size(), 18u);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[all.size() - 1 - i].nanoseconds, 199 - i);
}

TEST_F(Files, CaptureOfTheRunBeforeIsKept) {
  const fs::path path = folder / "a.pcap";
  for (const std::uint8_t i : {1, 2}) CaptureFile(path, 20'000).add(frame(100, i), std::chrono::nanoseconds(i));
  ASSERT_EQ(records(folder / "a.pcap.old").size(), 1u);
  EXPECT_EQ(records(folder / "a.pcap.old")[0].nanoseconds, 1u);
  CaptureFile(path, 200);  // there is no room for so large a one beside the new one
  EXPECT_EQ(records(path).size(), 0u);
  EXPECT_EQ(records(folder / "a.pcap.old")[0].nanoseconds, 1u);
}

TEST_F(Files, CaptureThatCannotBeMadeIsRefused) {
  EXPECT_THROW(CaptureFile("/no/such/folder/a.pcap", 0), std::invalid_argument);
}

TEST_F(Files, CaptureOnAFullDiskCountsWhatItLoses) {
  fs::create_symlink("/dev/full", folder / "a.pcap");
  CaptureFile capture(folder / "a.pcap", 0);
  for (int i = 0; i < 10; ++i) capture.add(frame(100), std::chrono::nanoseconds(0));
  EXPECT_TRUE(reaches([&] { return capture.frames_lost(); }, 10));
  EXPECT_EQ(capture.frames_written(), 0u);
}

/// A link of two queues.
class QueueLink : public Link {
 public:
  int descriptor() const override { return -1; }
  int receive(const FrameTaker& take) override {
    const std::deque<Frame> arrived = std::exchange(incoming, {});
    for (const Frame& next : arrived) take(next, Time(5));
    return static_cast<int>(arrived.size());
  }
  using Link::send;
  void send(const Frame* first, std::size_t count) override { outgoing.insert(outgoing.end(), first, first + count); }
  void tend() override { ++tended; }
  bool is_up() const override { return true; }
  MacAddress address() const override { return {2, 0, 0, 0, 0, 9}; }
  int mtu() const override { return 1234; }
  std::uint64_t frames_not_sent() const override { return 7; }
  bool keeps_frames() const override { return true; }

  std::deque<Frame> incoming;
  std::vector<Frame> outgoing;
  int tended = 0;
};

TEST_F(Files, CaptureLinkPassesEverythingOnAndWritesItDown) {
  {
    auto inner = std::make_unique<QueueLink>();
    QueueLink& queue = *inner;
    CaptureLink link(std::move(inner), std::make_shared<CaptureFile>(folder / "a.pcap", 0));
    queue.incoming = {frame(10, 1), frame(10, 2)};
    std::vector<Time> arrivals;
    EXPECT_EQ(link.receive([&](const Frame&, Time arrived) { arrivals.push_back(arrived); }), 2);
    EXPECT_EQ(arrivals, std::vector<Time>(2, Time(5)));
    const std::vector<Frame> sent = {frame(20, 3), frame(20, 4)};
    link.send(sent.data(), sent.size());
    link.tend();
    EXPECT_EQ(queue.outgoing.size(), 2u);
    EXPECT_EQ(queue.tended, 1);
    EXPECT_EQ(link.mtu(), 1234);
    EXPECT_EQ(link.frames_not_sent(), 7u);
    EXPECT_TRUE(link.keeps_frames());
  }
  const auto found = records(folder / "a.pcap");
  ASSERT_EQ(found.size(), 4u);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].octets.back(), i + 1);
  EXPECT_GT(found[0].seconds, 1'600'000'000u);
}

TEST_F(Files, LogHasItsHeaderAndRows) {
  CsvFile file(folder, "alice", "a.csv", "#a, b");
  file.add("1, 2");
  EXPECT_EQ(content(folder / "adhoc_communication/alice/a.csv"), "#a, b\n1, 2\n");
  EXPECT_EQ(file.rows_lost(), 0u);
}

// A node that crashed was started again, and nothing was left of what its logs said of that.
TEST_F(Files, LogOfTheRunBeforeIsKept) {
  const fs::path path = folder / "adhoc_communication/alice/a.csv";
  CsvFile(folder, "alice", "a.csv", "#a").add("1");
  CsvFile(folder, "alice", "a.csv", "#a").add("2");
  EXPECT_EQ(content(path), "#a\n2\n");
  EXPECT_EQ(content(path.string() + ".old"), "#a\n1\n");
}

TEST_F(Files, NoLogPathNoLog) {
  CsvFile file("", "alice", "a.csv", "#a, b");
  file.add("1, 2");
  EXPECT_EQ(file.rows_lost(), 0u);
}

TEST_F(Files, FullDiskLosesRowsAndIsTriedAgain) {
  const fs::path path = folder / "adhoc_communication/alice/a.csv";
  fs::create_directories(path.parent_path());
  fs::create_symlink("/dev/full", path);
  CsvFile file(folder, "alice", "a.csv", "#a");
  file.add("1");
  file.add("2");
  EXPECT_EQ(file.rows_lost(), 2u);
  fs::remove(path);
  file.add("3");
  EXPECT_EQ(file.rows_lost(), 2u);
  EXPECT_EQ(content(path), "#a\n3\n");
}

TEST_F(Files, LogFolderThatCannotBeMadeIsRefused) {
  std::ofstream(folder / "file") << "x";
  EXPECT_THROW(CsvFile(folder / "file", "alice", "a.csv", "#a"), std::invalid_argument);
}

TEST_F(Files, LogThatIsFullBeginsAnew) {
  const fs::path path = folder / "adhoc_communication/alice/a.csv";
  CsvFile file(folder, "alice", "a.csv", "#a", 10);
  for (const char* row : {"11", "22", "33", "44"}) file.add(row);
  EXPECT_EQ(content(path), "#a\n33\n44\n");
  EXPECT_EQ(content(path.string() + ".old"), "#a\n11\n22\n");
}

std::vector<std::string> lines(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> result;
  for (std::string line; std::getline(file, line);) result.push_back(line);
  return result;
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char character : line) {
    if (character == ',') {
      result.emplace_back();
    } else {
      result.back() += character;
    }
  }
  return result;
}

/// The values of a row by the names in the header.
std::map<std::string, std::string> by_column(const fs::path& path, std::size_t row) {
  const std::vector<std::string> all = lines(path);
  const std::vector<std::string> names = fields(all.at(0));
  const std::vector<std::string> values = fields(all.at(row));
  EXPECT_EQ(names.size(), values.size()) << all.at(row);
  std::map<std::string, std::string> result;
  for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) result[names[i]] = values[i];
  return result;
}

TEST_F(Files, RoutingTableIsLoggedWhenItChangesAndSummariesEveryFiveSeconds) {
  NetworkLogs logs(folder, "alice");
  Snapshot snapshot;
  for (long long time = 0; time < 11'000; time += 1000) {
    if (time == 3000) {
      snapshot.routes.resize(2);
      snapshot.routes[0].valid = true;
    }
    logs.add(snapshot, time);
  }
  const fs::path place = folder / "adhoc_communication/alice";
  const auto routes = lines(place / "routing_table.csv");
  ASSERT_EQ(routes.size(), 3u);
  EXPECT_EQ(routes[0], "#time,num_cr_entries,num_unicast_entries,num_multicast_entries,size");
  EXPECT_EQ(routes[1], "0,0,0,0,0");
  EXPECT_EQ(routes[2], "3000,0,1,0," + std::to_string(2 * sizeof(RouteState)));
  for (const char* name :
       {"packet_memory_consumption.csv", "unicast_datalink_transmission_summary.csv", "multicast.csv"}) {
    EXPECT_EQ(lines(place / name).size(), 4u) << name;  // header; 0, 5 and 10 s
    EXPECT_EQ(by_column(place / name, 3)["#time"], "10000") << name;
  }
}

TEST_F(Files, SummariesGoOnWhenTheClockWasSetBack) {
  NetworkLogs logs(folder, "alice");
  for (const long long time : {3'600'000, 0, 1000, 5000}) logs.add({}, time);
  const auto rows = lines(folder / "adhoc_communication/alice/multicast.csv");
  EXPECT_EQ(rows.size(), 4u);  // header; an hour, 0 and 5 s
}

TEST_F(Files, SummariesHaveTheCountersUnderTheirNames) {
  Snapshot snapshot;
  Statistics& statistics = snapshot.statistics;
  for (std::size_t type = 1; type < Statistics::kFrameTypes; ++type) {
    statistics.frames_sent_by_type[type] = 100 + type;
    statistics.frames_received_by_type[type] = 200 + type;
    statistics.bytes_sent_by_type[type] = 1000;
    statistics.bytes_received_by_type[type] = 2000;
  }
  statistics.unicast_data = {1, 2, 3, 4, 5};
  statistics.group_data = {6, 7, 8, 9, 10};
  statistics.frames_received_again = 11;
  snapshot.queues.packets = 5;
  snapshot.queues.group_packets = 2;
  snapshot.queues.stream_octets = 20;
  snapshot.queues.group_octets = 30;
  snapshot.queues.complete_group_octets = 40;
  snapshot.links.resize(2);
  snapshot.links[0].in_flight = 3;
  snapshot.links[1].in_flight = 4;
  NetworkLogs(folder, "alice").add(snapshot, 7);
  const fs::path place = folder / "adhoc_communication/alice";

  auto unicast = by_column(place / "unicast_datalink_transmission_summary.csv", 1);
  EXPECT_EQ(unicast.size(), 29u);
  EXPECT_EQ(unicast["#time"], "7");
  EXPECT_EQ(unicast["num_unique_data_frames_sent"], "1");
  EXPECT_EQ(unicast["num_unique_data_frames_forwarded"], "2");
  EXPECT_EQ(unicast["num_data_frames_resent"], "3");
  EXPECT_EQ(unicast["num_data_frames_reforwarded"], "4");
  EXPECT_EQ(unicast["num_acknowledgments_sent"], std::to_string(105 + 107));
  EXPECT_EQ(unicast["num_rreq_sent"], "102");
  EXPECT_EQ(unicast["num_rrep_sent"], "103");
  EXPECT_EQ(unicast["num_beacons_sent"], "101");
  EXPECT_EQ(unicast["num_unique_data_frames_received_directly"], "5");
  EXPECT_EQ(unicast["num_data_frames_received_directly"], "206");
  EXPECT_EQ(unicast["num_duplicate_frames_received"], "11");
  EXPECT_EQ(unicast["num_total_bytes_sent"], "10000");
  EXPECT_EQ(unicast["num_total_bytes_received"], "20000");

  auto multicast = by_column(place / "multicast.csv", 1);
  EXPECT_EQ(multicast.size(), 27u);
  EXPECT_EQ(multicast["num_mc_unique_data_frames_sent"], "6");
  EXPECT_EQ(multicast["num_mc_unique_data_frames_forwarded"], "7");
  EXPECT_EQ(multicast["num_mc_data_frames_resent"], "8");
  EXPECT_EQ(multicast["num_mc_data_frames_reforwarded"], "9");
  EXPECT_EQ(multicast["num_mc_unique_data_frames_received_directly"], "10");
  EXPECT_EQ(multicast["num_mc_total_bytes_sent"], "5000");
  const auto number = [](const std::string& text) { return std::stoll(text); };
  EXPECT_EQ(number(unicast["num_total_frames_sent"]) + number(multicast["num_mc_total_frames_sent"]), 1500 + 120);
  EXPECT_EQ(number(unicast["num_total_frames_received"]) + number(multicast["num_mc_total_frames_received"]),
            3000 + 120);

  auto memory = by_column(place / "packet_memory_consumption.csv", 1);
  EXPECT_EQ(memory.size(), 9u);
  EXPECT_EQ(memory["size_multicast_packets_complete"], "40");
  EXPECT_EQ(memory["size_multicast_packets_incomplete"], "30");
  EXPECT_EQ(memory["size_unicast_packets_incomplete"], "20");
  EXPECT_EQ(memory["running_unicast_link_threads"], "7");
  EXPECT_EQ(memory["running_multicast_threads"], "2");
  EXPECT_EQ(memory["running_unicast_transport_threads"], "3");
}

const MacAddress kAlice{2, 0, 0, 0, 0, 1};
const MacAddress kBob{2, 0, 0, 0, 0, 2};
const MacAddress kCarol{2, 0, 0, 0, 0, 0xc};

std::vector<Record> one_of_each() {
  const RouteEnds two_hops{kBob, kCarol, 2};
  return {{Time(5ms), SegmentEnded{17, 3, "carol", 1, Time(2ms), Time(5ms), true, two_hops}},
          {Time(6ms), FramePassed{"al,ice", kAlice, kBob, 9, Time(4ms), Time(6ms), 2}},
          {Time(7ms), SearchEnded{4, "bob", Time(1ms), Time(7ms), 2, 1, {kBob, kBob, 1}}},
          {Time(8ms), SearchEnded{5, "dave", Time(1ms), Time(8ms), 4, 0, {}}},
          {Time(9ms), RequestArrived{6, "carol", 2, false, two_hops}},
          {Time(10ms), RequestPassedOn{6, "carol", kBob}}};
}

TEST(RecordRows, HaveTheColumnsOfTheContract) {
  std::vector<std::string> rows;
  for (const Record& record : one_of_each()) rows.push_back(row_of(record, 1000));
  const std::vector<std::string> expected = {"1005,17/3,carol,1,1002,1005,1,2,02-00-00-00-00-02|02-00-00-00-00-0C,0",
                                             "1006,\"al,ice\",9,02-00-00-00-00-01,02-00-00-00-00-02,1004,1006,2",
                                             "1007,4,bob,1001,1007,1,2,1,02-00-00-00-00-02,0",
                                             "1008,5,dave,1001,,0,4,,,0",
                                             "1009,6,carol,2,2,0,02-00-00-00-00-0C|02-00-00-00-00-02",
                                             "1010,6,carol,02-00-00-00-00-02"};
  EXPECT_EQ(rows, expected);
}

TEST_F(Files, RecordsAreWrittenEachToItsLog) {
  const long long before = unix_milliseconds();
  {
    RecordLog log(folder, "alice");
    ASSERT_TRUE(log.wanted());
    log.add(one_of_each(), Time(10ms));
  }
  const fs::path place = folder / "adhoc_communication/alice";
  const std::map<std::string, std::pair<std::string, std::size_t>> expected = {
      {"transport_frames",
       {"#time,id,dst,retransmissions,start_time,end_time,success,route_length,route,multicast", 1}},
      {"unicast_link_transmission", {"#time,src,frame_id,mac_src,mac_dst,time_sent,time_ack,retransmissions", 1}},
      {"rreq_initiater",
       {"#time,rreq_id,dst,start_time,end_time,num_rrep_rcvd,num_rreq_sent,route_length,route,multicast", 2}},
      {"rreq_receiver", {"#time,rreq_id,src,counter,route_length,selected,route", 1}},
      {"rreq_intermediate", {"#time,rreq_id,src,rcvd_from", 1}}};
  for (const auto& [name, log] : expected) {
    const auto found = lines(place / (name + ".csv"));
    ASSERT_EQ(found.size(), 1 + log.second) << name;
    EXPECT_EQ(found[0], log.first);
  }
  auto row = by_column(place / "rreq_intermediate.csv", 1);
  EXPECT_GE(std::stoll(row["#time"]), before);
  EXPECT_LE(std::stoll(row["#time"]), unix_milliseconds());
}

TEST_F(Files, RecordsOnAFullDiskAreCountedAndHoldUpNobody) {
  const fs::path place = folder / "adhoc_communication/alice";
  fs::create_directories(place);
  for (const char* name :
       {"transport_frames", "unicast_link_transmission", "rreq_initiater", "rreq_receiver", "rreq_intermediate"}) {
    fs::create_symlink("/dev/full", place / (std::string(name) + ".csv"));
  }
  RecordLog log(folder, "alice");
  log.add(one_of_each(), Time(10ms));
  EXPECT_TRUE(reaches([&] { return log.rows_lost(); }, 6));
}

TEST_F(Files, RecordsBeyondTheBoundAreLostAndCounted) {
  RecordLog log(folder, "alice");
  log.add(std::vector<Record>(RecordLog::kMostWaiting + 10, one_of_each()[5]), Time(10ms));
  EXPECT_GE(log.rows_lost(), 10u);
}

TEST(RecordLogs, NoLogPathNoThread) { EXPECT_FALSE(RecordLog("", "alice").wanted()); }

}  // namespace
}  // namespace adhoc_communication
