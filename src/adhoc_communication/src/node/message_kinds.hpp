// What the services send: which payload, and how urgent it is.
#pragma once

#include <string>

#include "adhoc_communication/types.hpp"
#include "node/payload.hpp"

namespace adhoc_communication {

struct MessageKind {
  const char* service;
  PayloadType payload_type;
  Priority priority;
};

/// Throws std::invalid_argument for a service that sends no message of one type.
const MessageKind& kind_of(const std::string& service);

/// What send_message sends: with its definition each time, urgent unless it is large. Throws PayloadError for a type
/// or MD5 sum that is none.
SendRequest any_message_request(const std::string& destination, const std::string& topic,
                                const SerializedMessage& message);

}  // namespace adhoc_communication
