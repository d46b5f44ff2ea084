#include "node/key_file.hpp"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "link/file_descriptor.hpp"
#include "security/cipher.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMostKeys = 4;
constexpr std::size_t kMostOctets = 16'384;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw std::invalid_argument("key file '" + path + "' " + why);
}

void check_access(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    refuse(path, std::string("cannot be read (") + strerror(errno) +
                     "): make one with \"rosrun adhoc_communication team_key create FILE\" and copy it to each robot");
  }
  if (!S_ISREG(status.st_mode)) refuse(path, "is not a file");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) refuse(path, "can be read by others: chmod 600 " + path);
}

/// What a file says, without a copy anywhere that stays in memory.
class SecretText {
 public:
  SecretText() = default;
  SecretText(const SecretText&) = delete;
  SecretText& operator=(const SecretText&) = delete;
  ~SecretText() { explicit_bzero(octets_.data(), octets_.size()); }

  void read(const std::string& path) {
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.is_open()) refuse(path, std::string("cannot be read (") + strerror(errno) + ")");
    while (size_ < octets_.size()) {
      const ssize_t count = ::read(file.get(), octets_.data() + size_, octets_.size() - size_);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) refuse(path, std::string("cannot be read (") + strerror(errno) + ")");
      if (count == 0) return;
      size_ += static_cast<std::size_t>(count);
    }
    refuse(path, "is no file of keys: it has " + std::to_string(octets_.size()) + " octets or more");
  }

  /// The next line, without its end; nothing behind the last one.
  std::optional<std::string_view> line() {
    if (at_ == size_) return std::nullopt;
    const std::string_view rest(octets_.data() + at_, size_ - at_);
    const std::size_t end = rest.find('\n');
    at_ = end == std::string_view::npos ? size_ : at_ + end + 1;
    return rest.substr(0, end);
  }

 private:
  std::array<char, kMostOctets> octets_{};
  std::size_t size_ = 0;
  std::size_t at_ = 0;
};

std::optional<std::uint8_t> digit(char character) {
  if (character >= '0' && character <= '9') return static_cast<std::uint8_t>(character - '0');
  if (character >= 'a' && character <= 'f') return static_cast<std::uint8_t>(character - 'a' + 10);
  if (character >= 'A' && character <= 'F') return static_cast<std::uint8_t>(character - 'A' + 10);
  return std::nullopt;
}

/// False if the text is no key, of which a part may have been written.
bool parse_key(std::string_view text, TeamKey& key) {
  if (text.size() != 2 * key.size()) return false;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const auto high = digit(text[2 * i]);
    const auto low = digit(text[2 * i + 1]);
    if (!high || !low) return false;
    key[i] = static_cast<std::uint8_t>(*high << 4 | *low);
  }
  return true;
}

void parse_keys(SecretText& text, const std::string& path, std::vector<TeamKey>& keys) {
  int number = 1;
  for (auto line = text.line(); line; line = text.line(), ++number) {
    const std::string_view shown = line->substr(0, line->find_last_not_of(" \t\r") + 1);
    if (shown.empty() || shown[0] == '#') continue;
    if (keys.size() == kMostKeys) refuse(path, "holds more than " + std::to_string(kMostKeys) + " keys");
    if (!parse_key(shown, keys.emplace_back())) {
      refuse(path, "line " + std::to_string(number) + " is not a key of 64 hexadecimal digits");
    }
  }
  if (keys.empty()) refuse(path, "holds no key");
}

}  // namespace

std::vector<TeamKey> read_key_file(const std::string& path) {
  check_access(path);
  SecretText text;
  text.read(path);
  std::vector<TeamKey> keys;
  keys.reserve(kMostKeys);  // a vector that grew would leave them behind
  try {
    parse_keys(text, path, keys);
  } catch (...) {
    security::wipe(keys);
    throw;
  }
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
