// RFC 3561's promises about routes, checked on the tables of the whole team: no loops (A13.1), freshness that never
// decreases along a route (A13.2), stored sequence numbers that never go back (A2.5).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "violation.hpp"

namespace adhoc_communication {

class RouteInvariants {
 public:
  explicit RouteInvariants(std::size_t robots) : tables_(robots, Table(robots)) {}

  /// A run of a robot began; numbers of a later run are newer than all of an earlier one.
  void booted(std::size_t robot, const BootId& boot_id);
  /// The robot forgot everything.
  void crashed(std::size_t robot);
  /// The robot's table is now this one. Throws Violation.
  void changed(std::size_t robot, const std::vector<RouteState>& routes, Time now);

 private:
  struct Entry {
    bool present = false;
    bool valid = false;
    bool sequence_valid = false;
    std::size_t next_hop = 0;
    double cost = 0;
    int run = 0;  ///< of the destination; 0 unknown
    std::uint32_t sequence = 0;
    Time expires{0};

    bool usable(Time now) const { return present && valid && expires > now; }
  };
  using Table = std::vector<Entry>;  ///< by destination

  Entry entry_of(const RouteState& route) const;
  void check_history(std::size_t robot, std::size_t destination, const Entry& before, const Entry& after) const;
  void check_loop(std::size_t robot, std::size_t destination, Time now) const;
  void check_downhill(std::size_t robot, std::size_t destination, Time now) const;
  std::string text(std::size_t robot, std::size_t destination) const;

  std::vector<Table> tables_;
  std::map<std::uint64_t, int> runs_;  ///< order of starts by first octets of the boot id
};

}  // namespace adhoc_communication
