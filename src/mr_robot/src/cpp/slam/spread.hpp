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
  // rad, the direction of that axis.
  double along() const { return 0.5 * std::atan2(2.0 * xy(), xx() - yy()); }

 private:
  double xx() const { return xx_ - x_ * x_ / count_; }
  double yy() const { return yy_ - y_ * y_ / count_; }
  double xy() const { return xy_ - x_ * y_ / count_; }
  double difference() const { return std::hypot(0.5 * (xx() - yy()), xy()); }

  double x_ = 0.0, y_ = 0.0, xx_ = 0.0, yy_ = 0.0, xy_ = 0.0;
  int count_ = 0;
};

}  // namespace mr_robot::slam
