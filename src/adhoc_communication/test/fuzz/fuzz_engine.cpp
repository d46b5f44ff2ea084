// The whole protocol: the input is a sequence of operations on two engines.
#include "play.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  adhoc_communication::fuzz::play(data, size);
  return 0;
}
