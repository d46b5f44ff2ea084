// Does a robot whose wheels turn stand all the same? Then its laser goes on to see what it saw.
#pragma once

#include <vector>

#include "scan.hpp"

namespace mr_robot::slam {

class Standing {
 public:
  enum class Verdict {
    kUndecided,     // too little motion by odometry to tell
    kSeemsToStand,  // same, but rest explains the scan better
    kStands,
    kMoved,    // later scans are compared with this one
    kUnknown,  // same, after so much motion without a verdict
  };

  // One more scan.
  Verdict judge(const float* ranges, std::size_t size, const LaserGeometry& geometry, const Scan& scan,
                const Pose& odometry);

 private:
  void keep(const float* ranges, std::size_t size, const LaserGeometry& geometry, const Scan& scan,
            const Pose& odometry);

  std::vector<float> ranges_;  // of the scan that later ones are compared with
  LaserGeometry geometry_{};
  std::vector<Beam> beams_;
  Pose odometry_;
};

}  // namespace mr_robot::slam
