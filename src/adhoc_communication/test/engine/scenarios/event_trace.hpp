// The last events of a scenario, kept cheaply and written out only when somebody wants to read them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <deque>
#include <string>

#include "payloads.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {

class EventTrace {
 public:
  static constexpr std::size_t kTail = 60;

  /// `aloud`: every event is printed at once, too.
  explicit EventTrace(bool aloud) : aloud_(aloud) {}

  void heard(Time now, std::size_t robot, const Frame& frame) { add({now, robot, "hears", header_of(frame), {}}); }
  void sent(Time now, std::size_t robot, const Frame& frame) { add({now, robot, "sends", header_of(frame), {}}); }
  void note(Time now, std::string text) { add({now, 0, nullptr, {}, std::move(text)}); }

  std::string tail() const {
    std::string lines;
    for (const Line& line : lines_) lines += text(line) + "\n";
    return lines;
  }

 private:
  using Header = std::array<std::uint8_t, wire::kHeaderSize>;
  struct Line {
    Time at;
    std::size_t robot;
    const char* verb;  ///< null for a note
    Header header;
    std::string note;
  };

  static Header header_of(const Frame& frame) {
    Header header{};
    std::copy_n(frame.bytes.begin(), std::min(header.size(), frame.bytes.size()), header.begin());
    return header;
  }

  void add(Line line) {
    if (aloud_) std::printf("%s\n", text(line).c_str());
    if (lines_.size() == kTail) lines_.pop_front();
    lines_.push_back(std::move(line));
  }

  static std::string text(const Line& line) {
    char start[32];
    std::snprintf(start, sizeof start, "%10.6f ", static_cast<double>(line.at.count()) * 1e-9);
    if (line.verb == nullptr) return start + line.note;
    static constexpr std::array<const char*, Statistics::kFrameTypes> kTypes = {"unknown",
                                                                                "beacon",
                                                                                "route request",
                                                                                "route reply",
                                                                                "route error",
                                                                                "hop acknowledgment",
                                                                                "data",
                                                                                "transport acknowledgment",
                                                                                "broadcast data",
                                                                                "flood",
                                                                                "group activation",
                                                                                "group refusal",
                                                                                "group data",
                                                                                "group report",
                                                                                "route reply acknowledgment",
                                                                                "group receipts"};
    wire::Reader reader(line.header.data(), line.header.size());
    const auto header = wire::read_header(reader);
    const std::string frame = header ? std::string(kTypes[static_cast<std::size_t>(header->type)]) + " of " +
                                           name_of(header->sender) + " for " + name_of(header->next_hop) +
                                           ", counter " + std::to_string(header->counter) + ", link sequence " +
                                           std::to_string(header->link_sequence)
                                     : std::string("an unreadable frame");
    return start + Team::name(line.robot) + " " + line.verb + " " + frame;
  }

  static std::string name_of(const MacAddress& address) {
    return address == wire::kEverybody ? "everybody" : Team::name(std::size_t{address[4]} * 256 + address[5]);
  }

  bool aloud_;
  std::deque<Line> lines_;
};

}  // namespace adhoc_communication
