// Messages of any type as packets carry them. No ROS.
#pragma once

#include <stdexcept>
#include <string>
#include <tuple>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// The payload identifiers of the contract, and those for messages of any type.
enum class PayloadType : std::uint8_t {
  kString = 'A',
  kMap = 'M',
  kPosition = 'P',
  kPoint = 'p',
  kMapUpdate = 'U',
  kControl = 'C',
  kFrontier = 'F',
  kCluster = 'c',
  kAuction = 'a',
  kTwist = 'T',
  kQuaternion = 'Q',
  kRobotUpdate = 'R',
  kAnyMessage = 'X',         ///< with its definition
  kMessageByType = 'x',      ///< without: the receiver has been sent the definition before, or asks for it
  kDefinition = 'D',         ///< a definition alone
  kDefinitionRequest = 'd',  ///< asks for it
  kNewMember = 'n',          ///< from the root of a group to a source of latched messages: who has joined
};

/// What identifies a definition.
struct TypeName {
  std::string type;
  std::string md5sum;
  bool operator==(const TypeName& other) const { return type == other.type && md5sum == other.md5sum; }
  bool operator<(const TypeName& other) const { return std::tie(type, md5sum) < std::tie(other.type, other.md5sum); }
};

/// A message ready to be published, whatever its type.
struct SerializedMessage {
  std::string type;  ///< package/Name
  std::string md5sum;
  std::string definition;  ///< full text, as in bag files
  Bytes bytes;             ///< ROS serialisation
  bool latched = false;    ///< the topic it comes from is
};

class PayloadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The payload of kAnyMessage; without bytes, that of kDefinition.
Bytes encode_any_message(const SerializedMessage& message);
/// The payload of kMessageByType; without bytes, that of kDefinitionRequest.
Bytes encode_message_by_type(const SerializedMessage& message);

/// The payload is of one of these four types.
bool names_its_type(const PacketReceived& packet);
/// What one of these four holds. Throws PayloadError with one sentence.
SerializedMessage decode_any_message(const PacketReceived& packet);

/// Throws PayloadError unless `type` reads package/Name and `md5sum` is 32 hexadecimal digits.
void check_type(const std::string& type, const std::string& md5sum);

}  // namespace adhoc_communication
