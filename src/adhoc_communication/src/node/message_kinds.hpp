// What the typed services send: which payload, and how urgent it is.
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

}  // namespace adhoc_communication
