// An input of fuzz_engine, played from its beginning to its end.
#pragma once

#include <set>

#include "pair_of_engines.hpp"

namespace adhoc_communication::fuzz {

constexpr int kMostOperations = 24;  ///< longer plays find little more and take the time of many short ones

/// Returns the types of the input's frames that an engine took.
inline std::set<wire::FrameType> play(const std::uint8_t* data, std::size_t size, bool sealed = false) {
  PairOfEngines engines(sealed);
  Operands operands(data, size);
  for (int i = 0; i < kMostOperations && !operands.at_end(); ++i) engines.carry_out(operands);
  engines.finish();
  return engines.taken();
}

}  // namespace adhoc_communication::fuzz
