// replay_TARGET LONGEST VARIANTS FOLDER: a fuzzer's stored inputs, and as many variants of each, drawn from one seed,
// go through it once. What `make fuzz` does with libFuzzer for long, with the compiler and the time of an ordinary
// test.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <set>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;

std::vector<Input> read(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.insert(entry.path());
  std::vector<Input> inputs;
  for (const auto& path : files) {
    std::ifstream file(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return inputs;
}

class Variants {
 public:
  Variants(const std::vector<Input>& inputs, std::size_t longest) : inputs_(inputs), longest_(longest) {}

  Input of(const Input& input) {
    Input result = input;
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(&result);
    if (result.size() > longest_) result.resize(longest_);
    return result;
  }

 private:
  std::size_t below(std::size_t limit) { return random_() % limit; }

  void change(Input* input) {
    const std::size_t at = input->empty() ? 0 : below(input->size());
    const auto place = input->begin() + static_cast<std::ptrdiff_t>(at);
    const Input& other = inputs_[below(inputs_.size())];
    switch (input->empty() ? 4 : below(6)) {
      case 0:
        *place ^= static_cast<std::uint8_t>(1U << below(8));
        break;
      case 1:
        *place = static_cast<std::uint8_t>(below(256));
        break;
      case 2:
        *place = below(2) == 0 ? 0 : 255;
        break;
      case 3:
        input->resize(at);
        break;
      case 4:
        input->insert(place, 1 + below(8), static_cast<std::uint8_t>(below(256)));
        break;
      default:  // the rest of another one
        input->resize(at);
        if (at < other.size())
          input->insert(input->end(), other.begin() + static_cast<std::ptrdiff_t>(at), other.end());
    }
  }

  const std::vector<Input>& inputs_;
  std::size_t longest_;
  std::mt19937 random_{1};
};

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) return std::fprintf(stderr, "usage: %s LONGEST VARIANTS FOLDER\n", arguments[0]), 2;
  const std::vector<Input> inputs = read(arguments[3]);
  Variants variants(inputs, std::strtoul(arguments[1], nullptr, 10));
  const unsigned long each = std::strtoul(arguments[2], nullptr, 10);
  std::size_t played = 0;
  const auto play = [&](const Input& input) {
    // What is read beyond the end is beyond an allocation of this very size.
    const std::unique_ptr<std::uint8_t[]> copy(new std::uint8_t[input.size()]);
    std::copy(input.begin(), input.end(), copy.get());
    LLVMFuzzerTestOneInput(copy.get(), input.size());
    ++played;
  };
  for (const Input& input : inputs) {
    play(input);
    for (unsigned long i = 0; i < each; ++i) play(variants.of(input));
  }
  std::printf("%zu inputs\n", played);
  return 0;
}
