// Examples of everything that goes on the air, octet by octet: docs/protocol_vectors.json.
#pragma once

#include <string>
#include <vector>

#include "identity.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {

struct FrameVector {
  std::string name;
  wire::FrameHeader header;
  Bytes body;
  std::string fields;  ///< JSON, by the names in docs/protocol.md
};

/// Who the frames are for.
Identity vector_receiver();
/// What those that are sealed are sealed with.
TeamKey vector_team_key();
/// At least one of each frame type.
std::vector<FrameVector> frame_vectors();

/// All of the file.
std::string protocol_vectors();

}  // namespace adhoc_communication
