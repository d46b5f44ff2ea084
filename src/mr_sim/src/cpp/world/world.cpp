#include "world.hpp"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace mr_sim {

namespace {

std::vector<Polygon> place(const std::vector<Polygon>& footprint, const Pose& pose) {
  const mr_grid::Frame frame(pose);
  std::vector<Polygon> placed = footprint;
  for (Polygon& polygon : placed) {
    for (Point& point : polygon) point = frame * point;
  }
  return placed;
}

double reach(const std::vector<Polygon>& footprint) {
  double radius = 0.0;
  for (const Polygon& polygon : footprint) {
    for (const Point& point : polygon) radius = std::max(radius, std::hypot(point.x, point.y));
  }
  return radius;
}

bool touches(const Raster& raster, const Polygon& polygon) {
  for (size_t i = 0; i < polygon.size(); ++i) {
    if (raster.touches(polygon[i], polygon[(i + 1) % polygon.size()])) return true;
  }
  return false;
}

double uniform(std::mt19937_64& generator) { return static_cast<double>(generator() >> 11) * 0x1p-53; }

// Marsaglia's polar method, written out because std::normal_distribution differs between standard libraries.
std::pair<double, double> two_normals(std::mt19937_64& generator) {
  double u, v, s;
  do {
    u = 2.0 * uniform(generator) - 1.0;
    v = 2.0 * uniform(generator) - 1.0;
    s = u * u + v * v;
  } while (s >= 1.0 || s == 0.0);
  const double factor = std::sqrt(-2.0 * std::log(s) / s);
  return {u * factor, v * factor};
}

// Stage adds no noise to readings at maximum range; noisy ones may be negative or above the maximum. What is drawn does
// not depend on what is seen, and a kind of noise that a ranger lacks draws nothing.
void add_noise(const Ranger& ranger, std::mt19937_64& generator, float* ranges) {
  const bool constant = ranger.noise_variance > 0.0;
  const bool growing = ranger.noise_share > 0.0;
  if (!constant && !growing) return;
  const double deviation = std::sqrt(ranger.noise_variance);
  const float maximum = static_cast<float>(ranger.range_max);
  const auto disturb = [&](double normal, float& range) {
    const double even = growing ? 2.0 * uniform(generator) - 1.0 : 0.0;
    if (range < maximum) range += static_cast<float>(normal * deviation + even * ranger.noise_share * range);
  };
  for (int i = 0; i < ranger.samples; i += 2) {
    const auto [first, second] = constant ? two_normals(generator) : std::pair(0.0, 0.0);
    disturb(first, ranges[i]);
    if (i + 1 < ranger.samples) disturb(second, ranges[i + 1]);
  }
}

// Distance along a ray from the origin to the nearest of the polygons, and which that is.
std::pair<double, size_t> first_hit(const std::vector<Polygon>& polygons, const Point& direction) {
  std::pair<double, size_t> nearest{std::numeric_limits<double>::infinity(), 0};
  for (size_t index = 0; index < polygons.size(); ++index) {
    const Polygon& polygon = polygons[index];
    for (size_t i = 0; i < polygon.size(); ++i) {
      const double distance = ray_segment({0.0, 0.0}, direction, polygon[i], polygon[(i + 1) % polygon.size()]);
      if (distance < nearest.first) nearest = {distance, index};
    }
  }
  return nearest;
}

}  // namespace

World::World(std::shared_ptr<const Raster> obstacles, std::shared_ptr<const Raster> visible, double interval)
    : obstacles_(std::move(obstacles)), visible_(std::move(visible)), interval_(interval) {
  if (!(interval > 0.0)) throw std::invalid_argument("the simulation interval must be positive");
}

int World::add_robot(RobotOptions options) {
  if (options.intensities.size() != options.seen.size()) throw std::invalid_argument("one intensity for each polygon");
  Robot robot;
  robot.radius = reach(options.footprint);
  robot.outline = place(options.footprint, options.start);
  robot.noise.seed(options.noise_seed);
  robot.walk.seed(options.walk_seed);
  const Pose odometry = between(options.localization_origin, options.start);
  robot.state = {
      odometry.x, odometry.y, odometry.yaw, 0, 0, 0, options.start.x, options.start.y, options.start.yaw, 0, 0, 0,
      0,          0};
  for (const Ranger& ranger : options.rangers) {
    if (ranger.samples < 1) throw std::invalid_argument("a ranger needs at least one sample");
    Beams beams;
    beams.first = ranger.samples > 1 ? -ranger.field_of_view / 2.0 : 0.0;
    beams.increment = ranger.samples > 1 ? ranger.field_of_view / (ranger.samples - 1) : 0.0;
    beams.error = static_cast<int>(std::ceil(0.5 * ranger.noise_bearing));
    for (int i = 0; i < ranger.samples; ++i) {
      const double bearing = beams.first + i * beams.increment;
      beams.directions.push_back({std::cos(bearing), std::sin(bearing)});
    }
    robot.beams.push_back(std::move(beams));
  }
  robot.options = std::move(options);
  robots_.push_back(std::move(robot));
  return size() - 1;
}

World::Robot& World::at(int robot) { return robots_.at(static_cast<size_t>(robot)); }
const World::Robot& World::at(int robot) const { return robots_.at(static_cast<size_t>(robot)); }
const RobotState& World::state(int robot) const { return at(robot).state; }
int World::samples(int robot, int ranger) const { return at(robot).options.rangers.at(ranger).samples; }

void World::command(int robot, double linear, double lateral, double angular) {
  if (!std::isfinite(linear) || !std::isfinite(lateral) || !std::isfinite(angular)) {
    throw std::invalid_argument("a velocity command must be finite");
  }
  Robot& target = at(robot);
  target.wanted_linear = linear;
  target.wanted_lateral = lateral;
  target.wanted_angular = angular;
  target.commanded_at = time();
}

void World::reset_positions() {
  for (Robot& robot : robots_) {
    RobotState& state = robot.state;
    const Pose& start = robot.options.start;
    std::tie(state.x, state.y, state.yaw) = std::tie(start.x, start.y, start.yaw);
    state.velocity_x = state.velocity_y = state.velocity_yaw = 0.0;
    state.stalled = 0;
    state.contact = static_cast<uint8_t>(Contact::kNone);
    robot.outline = place(robot.options.footprint, start);
  }
}

void World::step() {
  for (Robot& robot : robots_) {
    if (steps_ % robot.options.base_steps == 0) take_up_command(robot);
  }
  ++steps_;
  for (int i = 0; i < size(); ++i) {
    move(i);
    count_odometry(robots_[i]);
  }
}

void World::take_up_command(Robot& robot) const {
  const RobotOptions& options = robot.options;
  // Half a step of tolerance: times are sums of steps, equal ones may differ in the last bit.
  const bool fresh = time() - robot.commanded_at < options.command_timeout - 0.5 * interval_;
  robot.state.linear = fresh ? std::clamp(robot.wanted_linear, options.linear_min, options.linear_max) : 0.0;
  robot.state.lateral = fresh ? std::clamp(robot.wanted_lateral, options.lateral_min, options.lateral_max) : 0.0;
  robot.state.angular = fresh ? std::clamp(robot.wanted_angular, options.angular_min, options.angular_max) : 0.0;
}

void World::move(int index) {
  Robot& robot = robots_[index];
  RobotState& state = robot.state;
  state.stalled = 0;
  state.contact = static_cast<uint8_t>(Contact::kNone);
  state.velocity_x = state.velocity_y = state.velocity_yaw = 0.0;
  if (state.linear == 0.0 && state.lateral == 0.0 && state.angular == 0.0) return;

  const Pose pose{state.x, state.y, state.yaw};
  const Pose next = pose * Pose{state.linear * interval_, state.lateral * interval_, state.angular * interval_};
  const Contact contact = contact_at(index, next);
  if (contact != Contact::kNone) {
    state.stalled = 1;
    state.contact = static_cast<uint8_t>(contact);
    return;
  }
  state.velocity_x = (next.x - pose.x) / interval_;
  state.velocity_y = (next.y - pose.y) / interval_;
  state.velocity_yaw = state.angular;
  state.x = next.x;
  state.y = next.y;
  state.yaw = next.yaw;
  robot.outline = place(robot.options.footprint, next);
}

// Wheels count whether or not the robot gets anywhere.
void World::count_odometry(Robot& robot) const {
  RobotState& state = robot.state;
  const RobotOptions& options = robot.options;
  Pose odometry{state.odometry_x, state.odometry_y, state.odometry_yaw};
  if (options.exact_localization) {
    odometry = between(options.localization_origin, {state.x, state.y, state.yaw});
  } else {
    odometry = odometry * wheel_motion(robot, interval_);
  }
  state.odometry_x = odometry.x;
  state.odometry_y = odometry.y;
  state.odometry_yaw = odometry.yaw;
}

// What the wheels count in one step. Of a random walk numbers are drawn at each step, also at rest.
Pose World::wheel_motion(Robot& robot, double interval) {
  const RobotState& state = robot.state;
  const auto& [bias, walk] = std::tie(robot.options.bias, robot.options.walk);
  Pose motion{state.linear * (1.0 + bias.linear) * interval, state.lateral * (1.0 + bias.lateral) * interval,
              state.angular * (1.0 + bias.angular) * interval};
  if (walk.linear > 0.0 || walk.angular > 0.0) {
    const auto [along, around] = two_normals(robot.walk);
    motion.x += along * walk.linear * std::sqrt(std::abs(motion.x));
    motion.yaw += around * walk.angular * std::sqrt(std::abs(motion.yaw));
  }
  if (walk.lateral > 0.0) {
    const double aside = two_normals(robot.walk).first;
    motion.y += aside * walk.lateral * std::sqrt(std::abs(motion.y));
  }
  return motion;
}

Contact World::contact_at(int index, const Pose& pose) const {
  const Robot& robot = at(index);
  if (!robot.options.solid) return Contact::kNone;
  const std::vector<Polygon> outline = place(robot.options.footprint, pose);
  for (const Polygon& polygon : outline) {
    if (touches(*obstacles_, polygon)) return Contact::kWall;
  }
  for (int i = 0; i < size(); ++i) {
    const Robot& other = robots_[i];
    const double distance = std::hypot(other.state.x - pose.x, other.state.y - pose.y);
    if (i == index || !other.options.solid || distance > robot.radius + other.radius) continue;
    for (const Polygon& mine : outline) {
      for (const Polygon& theirs : other.outline) {
        if (overlap(mine, theirs)) return Contact::kRobot;
      }
    }
  }
  return Contact::kNone;
}

void World::scan(int index, int ranger_index, float* ranges, float* intensities) {
  Robot& robot = at(index);
  const Ranger& ranger = robot.options.rangers.at(static_cast<size_t>(ranger_index));
  const Beams& exact = robot.beams[static_cast<size_t>(ranger_index)];
  const bool errs = ranger.noise_bearing > 0.0;
  const Beams wrong = errs ? disturbed(exact, ranger, robot.noise) : Beams{};
  const Beams& beams = errs ? wrong : exact;
  const Pose eye = Pose{robot.state.x, robot.state.y, robot.state.yaw} * ranger.mount;
  see_walls(ranger, beams, eye, ranges, intensities);
  for (int i = 0; i < size(); ++i) {
    if (i != index && !robots_[i].options.seen.empty()) {
      see_robot(robots_[i], ranger, beams, eye, ranges, intensities);
    }
  }
  add_noise(ranger, robot.noise, ranges);
}

// Beams that look beside the bearings they are reported at: evenly spread, as in Stage up to half of the share of the
// angle between two beams, or of the field of view if there is one only.
World::Beams World::disturbed(const Beams& beams, const Ranger& ranger, std::mt19937_64& generator) {
  Beams wrong = beams;
  const double between = ranger.field_of_view / std::max(ranger.samples - 1, 1);
  for (int i = 0; i < ranger.samples; ++i) {
    const double error = 0.5 * between * ranger.noise_bearing * (2.0 * uniform(generator) - 1.0);
    const double bearing = beams.first + i * beams.increment + error;
    wrong.directions[i] = {std::cos(bearing), std::sin(bearing)};
  }
  return wrong;
}

void World::see_walls(const Ranger& ranger, const Beams& beams, const Pose& eye, float* ranges,
                      float* intensities) const {
  const mr_grid::Frame frame(eye);
  for (int i = 0; i < ranger.samples; ++i) {
    const Point direction = frame.turned(beams.directions[i]);
    float* intensity = intensities ? intensities + i : nullptr;
    ranges[i] = static_cast<float>(visible_->cast({eye.x, eye.y}, direction, ranger.range_max, intensity));
  }
}

void World::see_robot(const Robot& target, const Ranger& ranger, const Beams& beams, const Pose& eye, float* ranges,
                      float* intensities) const {
  const Pose centre = between(eye, {target.state.x, target.state.y, 0.0});
  const double distance = std::hypot(centre.x, centre.y);
  if (distance > ranger.range_max + target.radius) return;
  const double bearing = std::atan2(centre.y, centre.x);
  const double half_width = distance > target.radius ? std::asin(target.radius / distance) : M_PI;
  const std::vector<Polygon> outline =
      place(target.options.seen, between(eye, {target.state.x, target.state.y, target.state.yaw}));
  // Only beams that may meet the target's circle are tested; a field of view may reach around to it from either side.
  for (const double turn : {-2.0 * M_PI, 0.0, 2.0 * M_PI}) {
    const double from = bearing + turn - half_width - beams.first;
    const double to = bearing + turn + half_width - beams.first;
    const double last = ranger.samples - 1;
    const bool single = beams.increment == 0.0;
    const double first_beam = std::floor(from / beams.increment) - beams.error;
    const double last_beam = std::ceil(to / beams.increment) + beams.error;
    const int begin = static_cast<int>(single ? 0.0 : std::clamp(first_beam, 0.0, last + 1.0));
    const int end = static_cast<int>(single ? 0.0 : std::clamp(last_beam, -1.0, last));
    for (int i = begin; i <= end; ++i) {
      const auto [distance, polygon] = first_hit(outline, beams.directions[i]);
      if (static_cast<float>(distance) >= ranges[i]) continue;
      ranges[i] = static_cast<float>(distance);
      if (intensities) intensities[i] = target.options.intensities[polygon];
    }
  }
}

}  // namespace mr_sim
