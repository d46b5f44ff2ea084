// What every frame passes on its way in and out: integrity, or with a team key authenticity, secrecy and freshness.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "identity.hpp"
#include "security/cipher.hpp"
#include "security/replay_window.hpp"

namespace adhoc_communication::security {

/// A frame that may be believed.
struct OpenedFrame {
  wire::FrameHeader header;
  Bytes plain;        ///< what `body` reads, when it had to be decrypted
  wire::Reader body;  ///< valid as long as this value and the frame live
};

/// Without keys, frames carry a checksum only. With keys, the first one seals; all of them open, so that a team can
/// change its key while it works.
///
/// A recorded frame carries a valid seal for ever. Against frames of the same run there is the replay window; against
/// those of an earlier run, or from before this robot's own start, a run counts as proven only once a beacon of it has
/// named this robot's own boot id. Until then nothing but its beacons is looked at.
///
/// At most kMostSessions runs are known; the unproven one, then the one idle longest makes room.
class FrameGuard {
 public:
  static constexpr std::size_t kMostSessions = 1024;

  FrameGuard(const Identity& self, std::vector<TeamKey> keys, FramesDropped& dropped);
  ~FrameGuard();
  FrameGuard(const FrameGuard&) = delete;
  FrameGuard& operator=(const FrameGuard&) = delete;

  bool seals() const { return !keys_.empty(); }
  void set_keys(std::vector<TeamKey> keys);
  const std::vector<TeamKey>& keys() const { return keys_; }

  /// The frame as it goes on the air.
  Bytes close(wire::FrameHeader header, const Bytes& body) const;
  /// Nothing for a frame that is not for this robot, or that is dropped; the reason is counted.
  std::optional<OpenedFrame> open(const Frame& frame, Time now);

  bool proven(const wire::FrameHeader& header) const;
  /// By this frame. What the run sent before may have been recorded before this robot's start, and counts as seen.
  void prove(const wire::FrameHeader& header);
  std::size_t sessions() const { return sessions_.size(); }

 private:
  using RunOfRobot = std::pair<MacAddress, BootId>;
  struct Session {
    Session() = default;
    ~Session() { forget_key(); }
    void forget_key();

    std::optional<SessionKey> key;  ///< that opened its last frame
    ReplayWindow window;
    bool proven = false;
    Time last_frame{0};
  };

  std::optional<OpenedFrame> open_sealed(const wire::FrameHeader& header, const Frame& frame, Time now);
  /// Tells which key it was.
  std::optional<Bytes> unseal_with_any_key(const wire::FrameHeader& header, const Bytes& frame, SessionKey& key) const;
  Session& session_of(const RunOfRobot& run);
  std::optional<OpenedFrame> drop(std::uint64_t& counter) const;

  const Identity& self_;
  std::vector<TeamKey> keys_;
  SessionKey own_key_{};
  FramesDropped& dropped_;
  std::map<RunOfRobot, Session> sessions_;
};

}  // namespace adhoc_communication::security
