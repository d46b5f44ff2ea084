// Which way do most walls run that a robot sees from one place?
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "scan.hpp"

namespace mr_robot::slam {

// Directions a quarter turn apart count as the same. What stands askew has no say, however much of it there is: even
// one slanted wall among many would turn their mean.
class SquareWalls {
 public:
  // `yaw`: rad, of the robot in the frame in which directions are counted.
  void add(const Scan& scan, double yaw);
  // rad; none where there is too little to see, or no such direction.
  std::optional<double> direction() const;

 private:
  static constexpr std::size_t kBins = 90;  // of a quarter turn
  struct Bin {
    float length = 0.0F;  // m along surfaces
    float turned = 0.0F;  // rad m, their directions from the middle of the bin, each times its length
  };

  static double middle(std::size_t bin);

  std::array<Bin, kBins> bins_{};
};

}  // namespace mr_robot::slam
