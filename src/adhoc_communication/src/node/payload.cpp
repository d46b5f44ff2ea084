#include "node/payload.hpp"

#include <adhoc_communication/CMgrRobotUpdate.h>
#include <adhoc_communication/ExpAuction.h>
#include <adhoc_communication/ExpCluster.h>
#include <adhoc_communication/ExpFrontier.h>
#include <adhoc_communication/MmControl.h>
#include <adhoc_communication/MmMapUpdate.h>
#include <adhoc_communication/MmPoint.h>
#include <adhoc_communication/MmRobotPosition.h>
#include <adhoc_communication/RecvString.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/message_traits.h>

#include "node/checked_stream.hpp"

namespace adhoc_communication {
namespace {

/// Only these name their sender (contract 1.4).
template <typename Message>
void set_sender(Message&, const std::string&) {}
void set_sender(MmRobotPosition& message, const std::string& sender) { message.src_robot = sender; }
void set_sender(MmPoint& message, const std::string& sender) { message.src_robot = sender; }
void set_sender(MmMapUpdate& message, const std::string& sender) { message.src_robot = sender; }
void set_sender(MmControl& message, const std::string& sender) { message.src_robot = sender; }

template <typename Message>
SerializedMessage ready(const Message& message) {
  namespace traits = ros::message_traits;
  return {traits::datatype<Message>(), traits::md5sum<Message>(), traits::definition<Message>(), serialize(message)};
}

template <typename Message>
SerializedMessage decode_as(const PacketReceived& packet) {
  if (packet.payload.empty()) throw PayloadError("ends before its message does");  // a stream needs an address
  Message message;
  CheckedStream stream(packet.payload.data(), packet.payload.size());
  stream.next(message);
  if (stream.getLength() != 0) throw PayloadError("has octets behind the end of the message");
  set_sender(message, packet.source);
  return ready(message);
}

/// A text may be large: it is copied once, behind its length and the sender.
SerializedMessage decode_string(const PacketReceived& packet) {
  RecvString message;
  message.src_robot = packet.source;
  SerializedMessage result = ready(message);
  ros::serialization::OStream length(result.bytes.data() + result.bytes.size() - 4, 4);
  length.next(static_cast<std::uint32_t>(packet.payload.size()));
  result.bytes.insert(result.bytes.end(), packet.payload.begin(), packet.payload.end());
  return result;
}

SerializedMessage decode_by_type(const PacketReceived& packet) {
  switch (static_cast<PayloadType>(packet.payload_type)) {
    case PayloadType::kString:
      return decode_string(packet);
    case PayloadType::kMap:
      return decode_as<nav_msgs::OccupancyGrid>(packet);
    case PayloadType::kPosition:
      return decode_as<MmRobotPosition>(packet);
    case PayloadType::kPoint:
      return decode_as<MmPoint>(packet);
    case PayloadType::kMapUpdate:
      return decode_as<MmMapUpdate>(packet);
    case PayloadType::kControl:
      return decode_as<MmControl>(packet);
    case PayloadType::kFrontier:
      return decode_as<ExpFrontier>(packet);
    case PayloadType::kCluster:
      return decode_as<ExpCluster>(packet);
    case PayloadType::kAuction:
      return decode_as<ExpAuction>(packet);
    case PayloadType::kTwist:
      return decode_as<geometry_msgs::Twist>(packet);
    case PayloadType::kQuaternion:
      return decode_as<geometry_msgs::Quaternion>(packet);
    case PayloadType::kRobotUpdate:
      return decode_as<CMgrRobotUpdate>(packet);
    case PayloadType::kAnyMessage:
    case PayloadType::kDefinition:
    case PayloadType::kMessageByType:
    case PayloadType::kDefinitionRequest:
      return decode_any_message(packet);
    case PayloadType::kNewMember:
      throw PayloadError("is no message");
  }
  throw PayloadError("has the unknown payload type " + std::to_string(packet.payload_type));
}

}  // namespace

SerializedMessage decode(const PacketReceived& packet) {
  try {
    return decode_by_type(packet);
  } catch (const ros::serialization::StreamOverrunException&) {
    throw PayloadError("ends before its message does");
  }
}

}  // namespace adhoc_communication
