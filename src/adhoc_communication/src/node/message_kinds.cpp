#include "node/message_kinds.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace adhoc_communication {
namespace {

constexpr std::size_t kBulkSize = 50'000;  ///< octets from which a message of any type yields to others

constexpr MessageKind kKinds[] = {
    {"send_string", PayloadType::kString, Priority::kNormal},
    {"send_map", PayloadType::kMap, Priority::kBulk},
    {"send_position", PayloadType::kPosition, Priority::kPosition},
    {"send_point", PayloadType::kPoint, Priority::kPosition},
    {"send_map_update", PayloadType::kMapUpdate, Priority::kBulk},
    {"send_control_message", PayloadType::kControl, Priority::kNormal},
    {"send_frontier", PayloadType::kFrontier, Priority::kNormal},
    {"send_cluster", PayloadType::kCluster, Priority::kNormal},
    {"send_auction", PayloadType::kAuction, Priority::kNormal},
    {"send_twist", PayloadType::kTwist, Priority::kPosition},
    {"send_quaternion", PayloadType::kQuaternion, Priority::kPosition},
    {"send_robot_update", PayloadType::kRobotUpdate, Priority::kNormal},
};

}  // namespace

const MessageKind& kind_of(const std::string& service) {
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [&](const MessageKind& kind) { return kind.service == service; });
  if (found == std::end(kKinds))
    throw std::invalid_argument("there is no service '" + service + "' that sends a message");
  return *found;
}

SendRequest any_message_request(const std::string& destination, const std::string& topic,
                                const SerializedMessage& message) {
  check_type(message.type, message.md5sum);
  const Priority priority = message.bytes.size() < kBulkSize ? Priority::kNormal : Priority::kBulk;
  return {destination, topic, static_cast<std::uint8_t>(PayloadType::kAnyMessage), encode_any_message(message),
          priority};
}

}  // namespace adhoc_communication
