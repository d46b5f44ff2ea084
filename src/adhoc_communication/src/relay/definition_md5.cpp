#include "relay/definition_md5.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "relay/message.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr int kDeepest = 32;
constexpr char kBlanks[] = " \t\r";
const std::set<std::string> kBuiltIn = {"bool",   "int8",     "uint8",  "int16",   "uint16",  "int32",
                                        "uint32", "int64",    "uint64", "float32", "float64", "string",
                                        "time",   "duration", "byte",   "char"};

using TextByType = std::map<std::string, std::string>;  ///< text by full type name
using Sums = std::map<std::string, std::string>;        ///< of types that are done: who uses one twice pays once

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::string package_of(const std::string& type) { return type.substr(0, type.find('/')); }

/// The first text is that of the type itself; each further one follows a line of '=' and a line "MSG: package/Name".
TextByType split(const std::string& type, const std::string& whole) {
  TextByType definitions;
  std::string current = type;
  std::istringstream lines(whole);
  bool named_next = false;
  for (std::string line; std::getline(lines, line);) {
    if (named_next && line.rfind("MSG: ", 0) == 0) {
      current = trimmed(line.substr(5));
      definitions[current];
    } else if (line.size() < 80 || line.find_first_not_of('=') != std::string::npos) {
      definitions[current] += line + "\n";
    }
    named_next = line.size() >= 80 && line.find_first_not_of('=') == std::string::npos;
  }
  return definitions;
}

using Digest = std::array<std::uint32_t, 4>;

/// One block of 64 octets (RFC 1321 section 3.4).
void mix(Digest& digest, const unsigned char* block) {
  constexpr int kShifts[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
  auto [a, b, c, d] = digest;
  for (std::uint32_t i = 0; i < 64; ++i) {
    std::uint32_t value = 0, word = 0;
    switch (i / 16) {
      case 0:
        value = (b & c) | (~b & d), word = i;
        break;
      case 1:
        value = (d & b) | (~d & c), word = (5 * i + 1) % 16;
        break;
      case 2:
        value = b ^ c ^ d, word = (3 * i + 5) % 16;
        break;
      default:
        value = c ^ (b | ~d), word = 7 * i % 16;
    }
    std::uint32_t input = 0;
    for (int octet = 3; octet >= 0; --octet) input = input << 8 | block[4 * word + static_cast<std::uint32_t>(octet)];
    const auto constant = static_cast<std::uint32_t>(std::floor(std::abs(std::sin(i + 1.0)) * 4294967296.0));
    const std::uint32_t sum = a + value + constant + input;
    const int shift = kShifts[i / 16][i % 4];
    a = std::exchange(d, std::exchange(c, std::exchange(b, b + (sum << shift | sum >> (32 - shift)))));
  }
  digest = {digest[0] + a, digest[1] + b, digest[2] + c, digest[3] + d};
}

std::string md5(std::string text) {
  const std::uint64_t bits = 8 * std::uint64_t{text.size()};
  text += '\x80';
  text.resize((text.size() + 8 + 63) / 64 * 64 - 8);
  for (int shift = 0; shift < 64; shift += 8) text += static_cast<char>(bits >> shift);
  Digest digest{0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476};
  for (std::size_t begin = 0; begin < text.size(); begin += 64) {
    mix(digest, reinterpret_cast<const unsigned char*>(text.data()) + begin);
  }
  std::string digits;
  for (const std::uint32_t word : digest) {
    for (int shift = 0; shift < 32; shift += 8) {
      digits += "0123456789abcdef"[word >> (shift + 4) & 15];
      digits += "0123456789abcdef"[word >> shift & 15];
    }
  }
  return digits;
}

std::string md5_of(const std::string& type, const TextByType& definitions, Sums& sums, int depth);

/// A field, or nothing for an empty line; constants are kept apart because they come first.
void take_line(const std::string& line, const std::string& package, const TextByType& definitions, Sums& sums,
               int depth, std::vector<std::string>& constants, std::vector<std::string>& fields) {
  const std::string without_comment = trimmed(line.substr(0, line.find('#')));
  const auto blank = without_comment.find_first_of(kBlanks);
  if (blank == std::string::npos) return;
  const std::string type = without_comment.substr(0, blank);
  const std::string rest = trimmed(without_comment.substr(blank));
  if (const auto equals = rest.find('='); equals != std::string::npos) {
    // What follows the '=' of a text is the text, with '#' and all.
    const std::string value =
        type == "string" ? trimmed(line.substr(line.find('=') + 1)) : trimmed(rest.substr(equals + 1));
    constants.push_back(type + " " + trimmed(rest.substr(0, equals)) + "=" + value);
    return;
  }
  const std::string element = type.substr(0, type.find('['));
  if (kBuiltIn.count(element) != 0) {
    fields.push_back(type + " " + rest);
    return;
  }
  std::string full = element == "Header" ? "std_msgs/Header" : element;
  if (full.find('/') == std::string::npos) full = package + "/" + full;
  fields.push_back(md5_of(full, definitions, sums, depth + 1) + " " + rest);
}

std::string md5_of(const std::string& type, const TextByType& definitions, Sums& sums, int depth) {
  if (const auto done = sums.find(type); done != sums.end()) return done->second;
  const auto found = definitions.find(type);
  if (found == definitions.end() || depth > kDeepest) {
    throw PayloadError("its definition lacks that of '" + escaped(type.substr(0, 256)) + "'");
  }
  std::vector<std::string> constants, fields;
  std::istringstream lines(found->second);
  for (std::string line; std::getline(lines, line);) {
    take_line(line, package_of(type), definitions, sums, depth, constants, fields);
  }
  constants.insert(constants.end(), fields.begin(), fields.end());
  std::string text;
  for (const std::string& line : constants) text += (text.empty() ? "" : "\n") + line;
  return sums[type] = md5(text);
}

}  // namespace

std::string md5_of_definition(const std::string& type, const std::string& definition) {
  TextByType definitions = split(type, definition);
  definitions[type];  // a message without fields
  Sums sums;
  return md5_of(type, definitions, sums, 0);
}

}  // namespace adhoc_communication
