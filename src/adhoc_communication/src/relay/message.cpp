#include "relay/message.hpp"

#include <regex>
#include <vector>

#include "texts.hpp"

namespace adhoc_communication {
namespace {

/// Texts as ROS serialises them, each behind its length in four octets, the lowest first; then the octets.
Bytes with_texts(const std::vector<const std::string*>& texts, const Bytes& octets) {
  std::size_t size = octets.size();
  for (const std::string* text : texts) size += 4 + text->size();
  Bytes bytes;
  bytes.reserve(size);
  for (const std::string* text : texts) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(text->size() >> shift));
    bytes.insert(bytes.end(), text->begin(), text->end());
  }
  bytes.insert(bytes.end(), octets.begin(), octets.end());
  return bytes;
}

/// Takes texts from the beginning of a payload.
class TextReader {
 public:
  explicit TextReader(const Bytes& octets) : octets_(octets) {}

  std::string next() {
    if (left() < 4) throw PayloadError("ends before its message does");
    std::size_t size = 0;
    for (std::size_t octet = 4; octet-- > 0;) size = size << 8 | octets_[begin_ + octet];
    begin_ += 4;
    if (left() < size) throw PayloadError("ends before its message does");
    const auto text = octets_.begin() + static_cast<std::ptrdiff_t>(begin_);
    begin_ += size;
    return {text, text + static_cast<std::ptrdiff_t>(size)};
  }
  Bytes rest() const { return {octets_.begin() + static_cast<std::ptrdiff_t>(begin_), octets_.end()}; }

 private:
  std::size_t left() const { return octets_.size() - begin_; }

  const Bytes& octets_;
  std::size_t begin_ = 0;
};

}  // namespace

Bytes encode_any_message(const SerializedMessage& message) {
  return with_texts({&message.type, &message.md5sum, &message.definition}, message.bytes);
}

Bytes encode_message_by_type(const SerializedMessage& message) {
  return with_texts({&message.type, &message.md5sum}, message.bytes);
}

bool names_its_type(const PacketReceived& packet) {
  switch (static_cast<PayloadType>(packet.payload_type)) {
    case PayloadType::kAnyMessage:
    case PayloadType::kMessageByType:
    case PayloadType::kDefinition:
    case PayloadType::kDefinitionRequest:
      return true;
    default:
      return false;
  }
}

SerializedMessage decode_any_message(const PacketReceived& packet) {
  const auto payload_type = static_cast<PayloadType>(packet.payload_type);
  SerializedMessage message;
  TextReader reader(packet.payload);
  message.type = reader.next();
  message.md5sum = reader.next();
  const bool with_definition = payload_type == PayloadType::kAnyMessage || payload_type == PayloadType::kDefinition;
  if (with_definition) message.definition = reader.next();
  check_type(message.type, message.md5sum);
  message.bytes = reader.rest();
  return message;
}

void check_type(const std::string& type, const std::string& md5sum) {
  static const std::regex type_pattern("[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*");
  static const std::regex md5sum_pattern("[0-9a-f]{32}");
  constexpr std::size_t kLongestType = 256;
  if (type.size() > kLongestType || !std::regex_match(type, type_pattern)) {
    throw PayloadError("type '" + escaped(type.substr(0, kLongestType)) + "' is not of the form package/Name");
  }
  if (md5sum.size() > kLongestType || !std::regex_match(md5sum, md5sum_pattern)) {
    throw PayloadError("md5sum '" + escaped(md5sum.substr(0, kLongestType)) + "' is not 32 hexadecimal digits");
  }
}

}  // namespace adhoc_communication
