// The work on payloads that takes time, for whatever thread of a host has it: an engine neither packs nor unpacks what
// users send.
#pragma once

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// Compresses the payload (zstd) where that makes it smaller. Once is enough.
void pack(SendRequest& request);
void pack(BroadcastRequest& request);

/// Gives the payload as it was sent. False if it is no such thing, and the packet of no use.
bool unpack(PacketReceived& packet);

}  // namespace adhoc_communication
