// Authenticated encryption of single frames (ChaCha20-Poly1305, RFC 8439, by libsodium).
#pragma once

#include <optional>

#include "adhoc_communication/options.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::security {

/// Belongs to one run of one robot, so that frame counters may start anew at each start without repeating a nonce, also
/// on a cloned disk.
using SessionKey = std::array<std::uint8_t, 32>;

/// Becomes BLAKE2b of sender and boot id, keyed with the team key. Written where it is to stand, so that no copy is
/// left in memory.
void derive_session_key(SessionKey& key, const TeamKey& team_key, const MacAddress& sender, const BootId& boot_id);

/// Nothing of them is left in memory.
void wipe(std::vector<TeamKey>& keys);

/// header | encrypted body | tag. The header stays readable and is authenticated.
Bytes seal(const SessionKey& key, const wire::FrameHeader& header, const Bytes& body);

/// The body, if header and body are what a holder of the key sealed. `frame` has at least kHeaderSize + kTagSize
/// octets.
std::optional<Bytes> unseal(const SessionKey& key, const Bytes& frame, std::uint64_t counter);

}  // namespace adhoc_communication::security
