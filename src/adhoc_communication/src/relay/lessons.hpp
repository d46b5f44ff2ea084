// Which destination knows the definition of which type.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "relay/message.hpp"

namespace adhoc_communication {

/// A definition goes to each destination once; while it is on its way, messages of that type wait for its end.
class Lessons {
 public:
  static constexpr std::size_t kMostKnown = 4096;  ///< pairs of destination and type

  bool known(const std::string& destination, const TypeName& type) const {
    return known_.count({destination, type}) != 0;
  }
  /// The definition is on its way there.
  bool under_way(const std::string& destination, const TypeName& type) const {
    return under_way_.count({destination, type}) != 0;
  }
  /// `transfer` carries it.
  void begin(const std::string& destination, const TypeName& type, std::uint64_t transfer) {
    under_way_[{destination, type}] = transfer;
  }
  /// Nothing happens unless that transfer carried it.
  void end(const std::string& destination, const TypeName& type, std::uint64_t transfer, bool delivered);
  /// What the destination knew is gone with its run; a definition on its way proves nothing any more.
  void forget(const std::string& destination);

 private:
  using Lesson = std::pair<std::string, TypeName>;  ///< a destination and a type

  std::set<Lesson> known_;
  std::map<Lesson, std::uint64_t> under_way_;  ///< and the transfer
};

}  // namespace adhoc_communication
