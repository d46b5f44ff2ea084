#include "security/frame_guard.hpp"

#include <sodium.h>

#include <algorithm>
#include <stdexcept>

namespace adhoc_communication::security {

namespace {

/// Of a key that is needed for a moment only.
class WipedKey {
 public:
  WipedKey() = default;
  ~WipedKey() { sodium_memzero(key.data(), key.size()); }
  WipedKey(const WipedKey&) = delete;
  WipedKey& operator=(const WipedKey&) = delete;

  SessionKey key{};
};

}  // namespace

FrameGuard::FrameGuard(const Identity& self, std::vector<TeamKey> keys, FramesDropped& dropped)
    : self_(self), dropped_(dropped) {
  set_keys(std::move(keys));
}

FrameGuard::~FrameGuard() {
  wipe(keys_);
  sodium_memzero(own_key_.data(), own_key_.size());
}

void FrameGuard::Session::forget_key() {
  if (key) sodium_memzero(key->data(), key->size());
  key.reset();
}

void FrameGuard::set_keys(std::vector<TeamKey> keys) {
  if (!keys.empty() && sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
  wipe(keys_);
  keys_ = std::move(keys);
  if (seals()) derive_session_key(own_key_, keys_.front(), self_.address, self_.boot_id);
  for (auto& [run, session] : sessions_) session.forget_key();
}

Bytes FrameGuard::close(wire::FrameHeader header, const Bytes& body) const {
  if (!seals()) return wire::close_openly(header, body);
  header.flags |= wire::kSealed;
  return seal(own_key_, header, body);
}

std::optional<OpenedFrame> FrameGuard::drop(std::uint64_t& counter) const {
  ++counter;
  return std::nullopt;
}

/// The cheap questions first: frames for others cost no cryptography.
std::optional<OpenedFrame> FrameGuard::open(const Frame& frame, Time now) {
  if (frame.destination != wire::kEverybody && frame.destination != self_.address) return std::nullopt;
  wire::Reader reader(frame.bytes);
  const std::optional<wire::FrameHeader> header = wire::read_header(reader);
  if (!header || header->sender != frame.source) return drop(dropped_.malformed);
  if (header->next_hop != wire::kEverybody && header->next_hop != self_.address) return std::nullopt;
  if (header->sender == self_.address) return drop(dropped_.reflected);
  const bool sealed = (header->flags & wire::kSealed) != 0;
  if (sealed != seals()) return drop(sealed ? dropped_.no_key : dropped_.unsealed);
  if (sealed) return open_sealed(*header, frame, now);
  const std::optional<wire::Reader> body = wire::open_body(frame.bytes);
  if (!body) return drop(dropped_.malformed);
  return OpenedFrame{*header, {}, *body};
}

std::optional<OpenedFrame> FrameGuard::open_sealed(const wire::FrameHeader& header, const Frame& frame, Time now) {
  if (frame.bytes.size() < wire::kHeaderSize + wire::kTagSize) return drop(dropped_.malformed);
  const RunOfRobot run{header.sender, header.boot_id};
  const auto known = sessions_.find(run);
  const bool seen = known != sessions_.end() ? known->second.window.seen(header.counter) : header.counter == 0;
  if (seen) return drop(dropped_.replayed);
  std::optional<Bytes> body;
  if (known != sessions_.end() && known->second.key) {
    body = unseal(*known->second.key, frame.bytes, header.counter);
  }
  WipedKey other;
  const bool anew = !body;
  if (anew) body = unseal_with_any_key(header, frame.bytes, other.key);
  if (!body) return drop(dropped_.forged);
  Session& session = known != sessions_.end() ? known->second : session_of(run);
  if (anew) session.key = other.key;
  session.window.take(header.counter);
  session.last_frame = now;
  OpenedFrame opened{header, std::move(*body), wire::Reader(nullptr, 0)};
  opened.body = wire::Reader(opened.plain);
  return opened;
}

std::optional<Bytes> FrameGuard::unseal_with_any_key(const wire::FrameHeader& header, const Bytes& frame,
                                                     SessionKey& key) const {
  for (const TeamKey& team_key : keys_) {
    derive_session_key(key, team_key, header.sender, header.boot_id);
    if (std::optional<Bytes> body = unseal(key, frame, header.counter)) return body;
  }
  return std::nullopt;
}

FrameGuard::Session& FrameGuard::session_of(const RunOfRobot& run) {
  if (sessions_.size() >= kMostSessions) {
    sessions_.erase(std::min_element(sessions_.begin(), sessions_.end(), [](const auto& a, const auto& b) {
      return std::pair(a.second.proven, a.second.last_frame) < std::pair(b.second.proven, b.second.last_frame);
    }));
  }
  return sessions_[run];
}

bool FrameGuard::proven(const wire::FrameHeader& header) const {
  if (!seals()) return true;
  const auto session = sessions_.find({header.sender, header.boot_id});
  return session != sessions_.end() && session->second.proven;
}

void FrameGuard::prove(const wire::FrameHeader& header) {
  const auto session = sessions_.find({header.sender, header.boot_id});
  if (session == sessions_.end()) return;
  session->second.proven = true;
  session->second.window.begin_behind(header.counter);
}

}  // namespace adhoc_communication::security
