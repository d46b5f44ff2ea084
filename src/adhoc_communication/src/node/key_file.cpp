#include "node/key_file.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

namespace adhoc_communication {
namespace {

constexpr std::size_t kMostKeys = 4;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw std::invalid_argument("key file '" + path + "' " + why);
}

void check_access(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    refuse(path, std::string("cannot be read (") + std::strerror(errno) +
                     "): make one with \"rosrun adhoc_communication team_key create FILE\" and copy it to each robot");
  }
  if (!S_ISREG(status.st_mode)) refuse(path, "is not a file");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) refuse(path, "can be read by others: chmod 600 " + path);
}

std::optional<std::uint8_t> digit(char character) {
  if (character >= '0' && character <= '9') return static_cast<std::uint8_t>(character - '0');
  if (character >= 'a' && character <= 'f') return static_cast<std::uint8_t>(character - 'a' + 10);
  if (character >= 'A' && character <= 'F') return static_cast<std::uint8_t>(character - 'A' + 10);
  return std::nullopt;
}

std::optional<TeamKey> key_of(const std::string& text) {
  TeamKey key{};
  if (text.size() != 2 * key.size()) return std::nullopt;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const auto high = digit(text[2 * i]);
    const auto low = digit(text[2 * i + 1]);
    if (!high || !low) return std::nullopt;
    key[i] = static_cast<std::uint8_t>(*high << 4 | *low);
  }
  return key;
}

}  // namespace

std::vector<TeamKey> read_key_file(const std::string& path) {
  check_access(path);
  std::ifstream file(path);
  std::vector<TeamKey> keys;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto end = line.find_last_not_of(" \t\r");
    line.resize(end == std::string::npos ? 0 : end + 1);
    if (line.empty() || line[0] == '#') continue;
    const auto key = key_of(line);
    if (!key) refuse(path, "line " + std::to_string(number) + " is not a key of 64 hexadecimal digits");
    keys.push_back(*key);
  }
  if (file.bad()) refuse(path, "cannot be read");
  if (keys.empty()) refuse(path, "holds no key");
  if (keys.size() > kMostKeys) refuse(path, "holds more than " + std::to_string(kMostKeys) + " keys");
  return keys;
}

FileWatch::FileWatch(std::string path) : path_(std::move(path)), last_(state()) {}

bool FileWatch::changed() { return std::exchange(last_, state()) != last_; }

std::string FileWatch::state() const {
  struct stat status {};
  if (stat(path_.c_str(), &status) != 0) return "absent";
  return std::to_string(status.st_ino) + " " + std::to_string(status.st_size) + " " +
         std::to_string(status.st_mtim.tv_sec) + "." + std::to_string(status.st_mtim.tv_nsec) + " " +
         std::to_string(status.st_mode);
}

}  // namespace adhoc_communication
