// corpus_types FOLDER: which types of frames the stored inputs of fuzz_engine, or of fuzz_sealed where the folder is of
// that name, let the engines take, one a line.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "play.hpp"

int main(int count, char** arguments) {
  if (count != 2) return std::fprintf(stderr, "usage: %s FOLDER\n", arguments[0]), 2;
  const bool sealed = std::filesystem::path(arguments[1]).filename() == "fuzz_sealed";
  std::set<adhoc_communication::wire::FrameType> types;
  for (const auto& entry : std::filesystem::directory_iterator(arguments[1])) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<std::uint8_t> input(std::istreambuf_iterator<char>(file), {});
    types.merge(adhoc_communication::fuzz::play(input.data(), input.size(), sealed));
  }
  for (const auto type : types) std::printf("%d\n", static_cast<int>(type));
  return 0;
}
