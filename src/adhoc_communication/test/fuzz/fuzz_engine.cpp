// The whole protocol: the input is a sequence of operations on two engines.
#include "pair_of_engines.hpp"

namespace {

constexpr int kMostOperations = 24;  ///< longer plays find little more and take the time of many short ones

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace fuzz = adhoc_communication::fuzz;
  fuzz::PairOfEngines engines;
  fuzz::Operands operands(data, size);
  for (int i = 0; i < kMostOperations && !operands.at_end(); ++i) engines.carry_out(operands);
  engines.finish();
  return 0;
}
