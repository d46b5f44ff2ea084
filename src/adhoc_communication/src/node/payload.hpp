// Between ROS messages and the payloads of packets. No node, no master: functions on bytes.
#pragma once

#include <ros/serialization.h>

#include <stdexcept>
#include <string>
#include <tuple>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// The payload identifiers of the contract, and one more for messages of any type.
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

template <typename Message>
Bytes serialize(const Message& message) {
  Bytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// The payload of kAnyMessage; without bytes, that of kDefinition.
Bytes encode_any_message(const SerializedMessage& message);
/// The payload of kMessageByType; without bytes, that of kDefinitionRequest.
Bytes encode_message_by_type(const SerializedMessage& message);

/// The message to publish for a packet: checked to the last octet, src_robot set to the true sender where the type has
/// it. Throws PayloadError with one sentence when the bytes are not what the payload type says.
SerializedMessage decode(const PacketReceived& packet);

/// Throws PayloadError unless `type` reads package/Name and `md5sum` is 32 hexadecimal digits.
void check_type(const std::string& type, const std::string& md5sum);

}  // namespace adhoc_communication
