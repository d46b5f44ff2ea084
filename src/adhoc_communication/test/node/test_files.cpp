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
#include <stdexcept>
#include <thread>

#include "link/capture_link.hpp"
#include "link/ethernet.hpp"
#include "node/csv_file.hpp"
#include "node/network_logs.hpp"

namespace adhoc_communication {
namespace {

namespace fs = std::filesystem;

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

struct Record {
  std::uint32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::string octets;
};

/// Fails the test unless the file is a whole pcap file.
std::vector<Record> records(const fs::path& path) {
  const std::string octets = content(path);
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, octets.data() + at, sizeof value);
    return value;
  };
  std::vector<Record> result;
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
  std::vector<Record> all = records(old);
  for (const Record& record : records(path)) all.push_back(record);
  EXPECT_GE(all.size(), 18u);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[all.size() - 1 - i].nanoseconds, 199 - i);
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

TEST_F(Files, RoutingTableIsLoggedWhenItChangesAndSummariesEveryFiveSeconds) {
  NetworkLogs logs(folder, "alice");
  NetworkState state;
  for (long long time = 0; time < 11'000; time += 1000) {
    if (time == 3000) {
      state.routes.resize(2);
      state.routes[0].valid = true;
    }
    logs.add(state, time);
  }
  const fs::path place = folder / "adhoc_communication/alice";
  EXPECT_EQ(content(place / "routing_table.csv"),
            "#time, num_cr_entries, num_unicast_entries, num_multicast_entries, size\n"
            "0, 0, 0, 0, 0\n3000, 0, 1, 0, 2\n");
  for (const char* name : {"packet_memory_consumption.csv", "unicast_datalink_transmission_summary.csv"}) {
    const std::string text = content(place / name);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4) << text;  // header; 0, 5 and 10 s
    const auto header_end = text.find('\n');
    const auto first_end = text.find('\n', header_end + 1);
    EXPECT_EQ(
        std::count(text.begin(), text.begin() + static_cast<long>(header_end), ','),
        std::count(text.begin() + static_cast<long>(header_end), text.begin() + static_cast<long>(first_end), ','));
  }
}

}  // namespace
}  // namespace adhoc_communication
