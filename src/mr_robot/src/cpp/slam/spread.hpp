// How points lie about their mean.
#pragma once

#include <cmath>

#include "pose.hpp"

namespace mr_robot::slam {

// Sums over points, and their principal axes.
class Spread {
 public:
  void add(const Point& point) {
    x_ += point.x, y_ += point.y;
    xx_ += point.x * point.x, yy_ += point.y * point.y, xy_ += point.x * point.y;
    ++count_;
  }
  int count() const { return count_; }
  Point mean() const { return {x_ / count_, y_ / count_}; }
  // Sums of squared distances from the mean: along the axis on which they are largest, and across it.
  double large() const { return 0.5 * (xx() + yy()) + difference(); }
  double small() const { return 0.5 * (xx() + yy()) - difference(); }
  // Unit vector of that axis.
  Point along() const {
    const double whole = difference(), share = whole > 0.0 ? 0.5 * (xx() - yy()) / whole : 1.0;
    const double larger = std::sqrt(0.5 * (1.0 + std::abs(share)));
    const double smaller = whole > 0.0 ? 0.5 * xy() / (whole * larger) : 0.0;
    if (share < 0.0) return {smaller, larger};
    return {larger, smaller};
  }

 private:
  double xx() const { return xx_ - x_ * x_ / count_; }
  double yy() const { return yy_ - y_ * y_ / count_; }
  double xy() const { return xy_ - x_ * y_ / count_; }
  double difference() const {
    const double half = 0.5 * (xx() - yy()), mixed = xy();
    return std::sqrt(half * half + mixed * mixed);
  }

  double x_ = 0.0, y_ = 0.0, xx_ = 0.0, yy_ = 0.0, xy_ = 0.0;
  int count_ = 0;
};

}  // namespace mr_robot::slam
