// Whose frames are looked at: those of runs that are proven to live now.
#pragma once

#include "presence/beacon_rhythm.hpp"
#include "routing/living_runs.hpp"
#include "routing/neighbors.hpp"
#include "security/frame_guard.hpp"

namespace adhoc_communication::presence {

class Admission {
 public:
  Admission(const Identity& self, security::FrameGuard& guard, routing::LivingRuns& runs, routing::Neighbors& neighbors,
            BeaconRhythm& rhythm, FramesDropped& dropped)
      : self_(self), guard_(guard), runs_(runs), neighbors_(neighbors), rhythm_(rhythm), dropped_(dropped) {}

  bool admits(const security::OpenedFrame& opened, Time now);

 private:
  bool proves_itself(const security::OpenedFrame& opened, Time now);
  bool answers(const security::OpenedFrame& opened) const;
  bool lives(const security::OpenedFrame& opened, Time now);

  const Identity& self_;
  security::FrameGuard& guard_;
  routing::LivingRuns& runs_;
  routing::Neighbors& neighbors_;
  BeaconRhythm& rhythm_;
  FramesDropped& dropped_;
};

}  // namespace adhoc_communication::presence
