// Robots in a world of walls: motion, collision, odometry and laser scans with the semantics of Stage.
// Pure: no clock, no I/O; the same seeds and calls give the same bits.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "geometry.hpp"
#include "raster.hpp"

namespace mr_sim {

struct Ranger {
  Pose mount;            // in the robot's frame
  double range_max;      // m
  double field_of_view;  // rad, first and last beam at its ends
  int samples;
  double noise_variance;  // m^2, the first number of Stage's `noise`
  double noise_share;     // of the range, the second number: largest error of its even part
  double noise_bearing;   // the third number, in rad: share of the angle between beams, half of which a beam may err
};

// Along the heading, to the left, of the turn.
struct OdometryError {
  double linear, lateral, angular;
};

struct RobotOptions {
  Pose start;                       // world frame
  std::vector<Polygon> footprint;   // robot frame
  std::vector<Polygon> seen;        // of these, by ranger_return: what other robots' lasers see
  std::vector<float> intensities;   // of the echoes of `seen`
  double linear_min, linear_max;    // velocity_bounds, m/s
  double lateral_min, lateral_max;  // m/s to the left; both 0 but for an omnidirectional drive
  double angular_min, angular_max;  // rad/s
  Pose localization_origin;         // world frame: where the odometry counts from
  bool exact_localization;          // localization "gps"
  OdometryError bias;               // shares by which odometry counts too much
  OdometryError walk;               // standard deviation of what it errs in 1 m or 1 rad, grows with the square root
  uint64_t walk_seed;
  int base_steps;          // simulation steps per base update
  double command_timeout;  // s of simulated time without a command after which the robot stops
  bool solid;              // obstacle_return: it bumps into walls and robots, and they into it
  uint64_t noise_seed;
  std::vector<Ranger> rangers;
};

enum class Contact : uint8_t { kNone = 0, kWall = 1, kRobot = 2 };

// Plain layout: handed to Python as a NumPy record.
struct RobotState {
  double odometry_x, odometry_y, odometry_yaw;  // robot's odometry frame
  double linear, lateral, angular;              // wheels: m/s, m/s to the left, rad/s
  double x, y, yaw;                             // truth, world frame
  double velocity_x, velocity_y, velocity_yaw;  // truth, world frame
  uint8_t stalled;                              // 1: the last step was blocked
  uint8_t contact;                              // what the footprint would have overlapped, see Contact
};

class World {
 public:
  // `obstacles` block, `visible` is what lasers see; `interval`: s of simulated time per step.
  World(std::shared_ptr<const Raster> obstacles, std::shared_ptr<const Raster> visible, double interval);

  int add_robot(RobotOptions options);

  // Wanted velocity, taken up at the robot's next base update. Throws std::invalid_argument unless finite.
  void command(int robot, double linear, double lateral, double angular);

  // All robots stand at their start poses again. Commands go on, and so does odometry, unless it is exact and shows the
  // start pose from the next step on.
  void reset_positions();

  // Advances the world by one interval.
  void step();

  double time() const { return static_cast<double>(steps_) * interval_; }
  int64_t steps() const { return steps_; }
  int size() const { return static_cast<int>(robots_.size()); }
  const RobotState& state(int robot) const;

  // What the footprint would overlap with the robot at `pose`.
  Contact contact_at(int robot, const Pose& pose) const;

  // One sweep of a ranger from the robot's present pose: `samples` ranges in metres, counter-clockwise, and, unless
  // null, as many intensities.
  void scan(int robot, int ranger, float* ranges, float* intensities = nullptr);
  int samples(int robot, int ranger) const;

 private:
  struct Beams {
    std::vector<Point> directions;  // unit vectors in the ranger's frame
    double first, increment;        // rad
    int error;                      // beams by which a bearing may be wrong
  };
  struct Robot {
    RobotOptions options;
    RobotState state;
    std::vector<Polygon> outline;  // footprint in the world frame at the present pose
    double radius;
    double wanted_linear = 0.0;
    double wanted_lateral = 0.0;
    double wanted_angular = 0.0;
    double commanded_at = -std::numeric_limits<double>::infinity();
    std::vector<Beams> beams;
    std::mt19937_64 noise;
    std::mt19937_64 walk;
  };

  Robot& at(int robot);
  const Robot& at(int robot) const;
  void take_up_command(Robot& robot) const;
  void move(int index);
  void count_odometry(Robot& robot) const;
  static Pose wheel_motion(Robot& robot, double interval);
  static Beams disturbed(const Beams& beams, const Ranger& ranger, std::mt19937_64& generator);
  void see_walls(const Ranger& ranger, const Beams& beams, const Pose& eye, float* ranges, float* intensities) const;
  void see_robot(const Robot& target, const Ranger& ranger, const Beams& beams, const Pose& eye, float* ranges,
                 float* intensities) const;

  std::shared_ptr<const Raster> obstacles_;
  std::shared_ptr<const Raster> visible_;
  double interval_;
  int64_t steps_ = 0;
  std::vector<Robot> robots_;
};

}  // namespace mr_sim
