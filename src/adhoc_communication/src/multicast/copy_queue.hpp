// Packets of the own group for members by themselves: a few members are served at a time, the others wait.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "multicast/groups.hpp"
#include "transport/priorities.hpp"
#include "transport/sending.hpp"

namespace adhoc_communication::multicast {

struct WaitingCopy {
  std::string member;
  HeldPacket packet;
  transport::Purpose purpose = transport::Purpose::kFanOut;
  SendId parent = 0;
};

/// A copy takes a frame and its acknowledgments on every hop. A whole crowd's at once would take all the air, and get
/// nowhere. Priorities do not wait for each other; whoever is served gets all that there is for it, in order.
class CopyQueue {
 public:
  static constexpr std::size_t kMostServed = 4;  ///< members, of a priority

  void add(WaitingCopy copy);
  /// The next one that is to go out.
  std::optional<WaitingCopy> next();
  /// A copy that went out has come to its end.
  void finished(const std::string& member, std::uint8_t stream);
  /// Takes out those of a send that wait.
  std::vector<WaitingCopy> drop(SendId parent);

 private:
  struct Line {
    std::map<std::string, std::size_t> served;               ///< copies of each that are under way
    std::map<std::string, std::deque<WaitingCopy>> waiting;  ///< by member; none is empty
    std::deque<std::string> turns;                           ///< those who wait, in the order of their first copy
    std::deque<WaitingCopy> ready;
  };

  static void serve_next(Line& line);

  std::array<Line, transport::kPriorities> lines_;
};

}  // namespace adhoc_communication::multicast
