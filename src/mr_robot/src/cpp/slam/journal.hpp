// What has to be written down of a map so that it can be drawn again by a SLAM that is started anew: its scans, what
// ties their places together, and where the places turned out to be. Octets in the order of this computer.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "odometry_model.hpp"
#include "scan.hpp"

namespace mr_robot::slam {

// A scan that entered the map at `pose`. `opens`: with a new keyframe, whose odometry and way they are.
struct JournalScan {
  bool opens;
  Pose pose, odometry;
  Way way;
  LaserGeometry geometry;
  std::vector<float> ranges;
};

// As in `PoseGraph::link`, between keyframes. A sure one closes a loop.
struct JournalLink {
  std::size_t from, to;
  Pose relative;
  Eigen::Matrix3d information;
  bool sure;
};

// Of all keyframes, after the map was drawn anew. `closing`: without the last sure links, which are yet to be followed.
struct JournalPoses {
  bool closing;
  std::vector<Pose> poses;
};

using JournalEntry = std::variant<JournalScan, JournalLink, JournalPoses>;

class Journal {
 public:
  // Until then nothing is written.
  void begin() { kept_ = true; }
  void write(const JournalScan& scan);
  void write(const JournalLink& link);
  void write(const JournalPoses& poses);
  bool kept() const { return kept_; }
  // What was written since.
  std::string take();

 private:
  bool kept_ = false;
  std::string written_;
};

// Up to the first that is not whole or makes no sense, as the last one of a process that was killed; `*used`: octets.
std::vector<JournalEntry> entries_of(std::string_view written, std::size_t* used);

}  // namespace mr_robot::slam
