// Room that several queues share.
#pragma once

#include <cstddef>

namespace adhoc_communication {

class OctetBudget {
 public:
  explicit OctetBudget(std::size_t most) : most_(most) {}

  bool fits(std::size_t octets) const { return taken_ + octets <= most_; }
  void take(std::size_t octets) { taken_ += octets; }
  void give_back(std::size_t octets) { taken_ -= octets; }

 private:
  std::size_t most_;
  std::size_t taken_ = 0;
};

}  // namespace adhoc_communication
