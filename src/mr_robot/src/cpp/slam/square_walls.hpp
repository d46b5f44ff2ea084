// Which way do most walls run that a robot sees from one place?
#pragma once

#include <complex>
#include <optional>

#include "scan.hpp"

namespace mr_robot::slam {

// Directions a quarter turn apart count as the same.
class SquareWalls {
 public:
  // `yaw`: rad, of the robot in the frame in which directions are counted.
  void add(const Scan& scan, double yaw);
  // rad; none where there is too little to see, or no such direction.
  std::optional<double> direction() const;

 private:
  std::complex<double> sum_ = 0.0;  // m along surfaces, at four times the angle of their normals
  double length_ = 0.0;             // m
};

}  // namespace mr_robot::slam
