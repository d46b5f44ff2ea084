#include "security/cipher.hpp"

#include <sodium.h>

namespace adhoc_communication::security {
namespace {

static_assert(crypto_aead_chacha20poly1305_ietf_KEYBYTES == std::tuple_size<SessionKey>::value);
static_assert(crypto_aead_chacha20poly1305_ietf_ABYTES == wire::kTagSize);

constexpr char kPurpose[] = "adhoc_communication frame v1";

using Nonce = std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES>;

Nonce nonce_of(std::uint64_t counter) {
  Nonce nonce{};
  for (std::size_t i = 0; i < 8; ++i) nonce[nonce.size() - 1 - i] = static_cast<std::uint8_t>(counter >> 8 * i);
  return nonce;
}

}  // namespace

void derive_session_key(SessionKey& key, const TeamKey& team_key, const MacAddress& sender, const BootId& boot_id) {
  Bytes input(kPurpose, kPurpose + sizeof kPurpose);
  input.insert(input.end(), sender.begin(), sender.end());
  input.insert(input.end(), boot_id.begin(), boot_id.end());
  crypto_generichash(key.data(), key.size(), input.data(), input.size(), team_key.data(), team_key.size());
}

void wipe(std::vector<TeamKey>& keys) {
  for (TeamKey& key : keys) sodium_memzero(key.data(), key.size());
  keys.clear();
}

Bytes seal(const SessionKey& key, const wire::FrameHeader& header, const Bytes& body) {
  Bytes frame;
  frame.reserve(wire::kHeaderSize + body.size() + wire::kTagSize);
  wire::Writer writer(frame);
  write(writer, header);
  frame.resize(wire::kHeaderSize + body.size() + wire::kTagSize);
  crypto_aead_chacha20poly1305_ietf_encrypt(frame.data() + wire::kHeaderSize, nullptr, body.data(), body.size(),
                                            frame.data(), wire::kHeaderSize, nullptr, nonce_of(header.counter).data(),
                                            key.data());
  return frame;
}

std::optional<Bytes> unseal(const SessionKey& key, const Bytes& frame, std::uint64_t counter) {
  Bytes body(frame.size() - wire::kHeaderSize - wire::kTagSize);
  const int verdict = crypto_aead_chacha20poly1305_ietf_decrypt(
      body.data(), nullptr, nullptr, frame.data() + wire::kHeaderSize, frame.size() - wire::kHeaderSize, frame.data(),
      wire::kHeaderSize, nonce_of(counter).data(), key.data());
  if (verdict != 0) return std::nullopt;
  return body;
}

}  // namespace adhoc_communication::security
