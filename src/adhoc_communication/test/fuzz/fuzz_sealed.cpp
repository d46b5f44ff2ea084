// As fuzz_engine, in a team with a key. The fuzzer has it, too: an insider, who seals the frames that it makes.
#include "play.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  adhoc_communication::fuzz::play(data, size, true);
  return 0;
}
