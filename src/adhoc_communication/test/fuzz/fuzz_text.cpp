// What people and programs write: key files, addresses, topic patterns, commands of the radio. The first octet selects
// the reader, the others are the text.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "link/mac_address.hpp"
#include "node/key_file.hpp"
#include "radio/control.hpp"
#include "relay/topic_filter.hpp"

namespace adhoc_communication {
namespace {

void check_key_file(const std::string& text) {
  static const int file = memfd_create("keys", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  const bool ready = file >= 0 && fchmod(file, 0600) == 0 && ftruncate(file, 0) == 0 &&
                     pwrite(file, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!ready) std::abort();
  try {
    const std::vector<TeamKey> keys = read_key_file(path);
    if (keys.empty() || keys.size() > 4) std::abort();
  } catch (const std::invalid_argument&) {
  }
}

void check_address(const std::string& text) {
  try {
    const MacAddress address = parse_mac_address(text);
    if (parse_mac_address(to_text(address)) != address) std::abort();
  } catch (const std::invalid_argument&) {
  }
}

void check_radio(const std::string& text) {
  Medium medium({}, 1);
  medium.add_node("robot_0");
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    carry_out(text.substr(begin, end - begin), medium, Time(0));
    begin = end + 1;
  }
  for (Medium::Node node = 0; node < medium.node_count(); ++node) medium.in_range(0, node);
  statistics_json(medium);
}

void check(std::uint8_t reader, const std::string& text) {
  const std::size_t half = text.size() / 2;
  switch (reader % 4) {
    case 0:
      return check_key_file(text);
    case 1:
      return check_address(text);
    case 2:
      TopicFilter(text.substr(0, half), text.substr(half)).admits("/robot_0/map");
      return;
    case 3:
      return check_radio(text);
  }
}

}  // namespace
}  // namespace adhoc_communication

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) adhoc_communication::check(data[0], std::string(data + 1, data + size));
  return 0;
}
