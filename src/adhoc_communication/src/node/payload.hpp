// Between ROS messages and the payloads of packets. No node, no master: functions on bytes.
#pragma once

#include <ros/serialization.h>

#include "adhoc_communication/types.hpp"
#include "relay/message.hpp"

namespace adhoc_communication {

template <typename Message>
Bytes serialize(const Message& message) {
  Bytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// The message to publish for a packet: checked to the last octet, src_robot set to the true sender where the type has
/// it. Throws PayloadError with one sentence when the bytes are not what the payload type says.
SerializedMessage decode(const PacketReceived& packet);

}  // namespace adhoc_communication
