// Python module _mrpt_peer: MRPT's reactive navigator behind one call per command, to compare navigation with.
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/core/Clock.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>
#include <mrpt/nav/reactive/CRobot2NavInterface.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace py = pybind11;
using mrpt::kinematics::CVehicleVelCmd;
using mrpt::kinematics::CVehicleVelCmd_DiffDriven;
using mrpt::math::TPose2D;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Pair = std::pair<double, double>;
using Triple = std::tuple<double, double, double>;

constexpr double kEpoch = 1.0;     // s: MRPT takes time 0 for none
constexpr double kBetween = 60.0;  // s from a scene to the next

// What the navigator sees of the robot, and what it commands.
class Robot : public mrpt::nav::CRobot2NavInterface {
 public:
  Robot() : CRobot2NavInterface() { setMinLoggingLevel(mrpt::system::LVL_ERROR); }

  bool getCurrentPoseAndSpeeds(TPose2D& at, mrpt::math::TTwist2D& moving, mrpt::system::TTimeStamp& moment,
                               TPose2D& odometry, std::string&) override {
    at = odometry = pose;
    moving = {velocity.first * std::cos(pose.phi), velocity.first * std::sin(pose.phi), velocity.second};
    moment = mrpt::Clock::now();
    return true;
  }

  bool changeSpeeds(const CVehicleVelCmd& command) override {
    const auto& wheels = dynamic_cast<const CVehicleVelCmd_DiffDriven&>(command);
    commanded = {wheels.lin_vel, wheels.ang_vel};
    return true;
  }

  bool stop(bool) override {
    commanded = {0.0, 0.0};
    return true;
  }

  CVehicleVelCmd::Ptr getStopCmd() override {
    auto command = CVehicleVelCmd_DiffDriven::Create();
    command->setToStop();
    return command;
  }

  CVehicleVelCmd::Ptr getEmergencyStopCmd() override { return getStopCmd(); }

  CVehicleVelCmd::Ptr getAlignCmd(double heading) override {
    auto command = CVehicleVelCmd_DiffDriven::Create();
    command->lin_vel = 0.0;
    command->ang_vel = std::copysign(std::min(0.8, 2.0 * std::abs(heading)), heading);
    return command;
  }

  bool senseObstacles(mrpt::maps::CSimplePointsMap& points, mrpt::system::TTimeStamp& moment) override {
    points = obstacles;
    moment = mrpt::Clock::now();
    return true;
  }

  double getNavigationTime() override { return time; }
  void resetNavigationTimer() override {}

  TPose2D pose;
  Pair velocity{0.0, 0.0}, commanded{0.0, 0.0};
  mrpt::maps::CSimplePointsMap obstacles;
  double time = 0.0;
};

class Navigator {
 public:
  explicit Navigator(const std::string& settings) : navigator_(robot_, false, false) {
    set_time(0.0);
    mrpt::Clock::setActiveClock(mrpt::Clock::Simulated);
    navigator_.logging_enable_console_output = false;
    navigator_.loadConfigFile(mrpt::config::CConfigFileMemory(settings));
    navigator_.initialize();
  }

  ~Navigator() { mrpt::Clock::setActiveClock(mrpt::Clock::Realtime); }

  // A new target, m, in the frame of the poses. `allowed`: m from it that count as there. `speed`: there, of the most.
  void go(const Pair& target, double allowed, double speed) {
    if (navigator_.getCurrentState() == Navigator_::NAV_ERROR) navigator_.resetNavError();
    Navigator_::TNavigationParams goal;
    goal.target.target_coords = {target.first, target.second, 0.0};
    goal.target.targetAllowedDistance = static_cast<float>(allowed);
    goal.target.targetDesiredRelSpeed = speed;
    navigator_.navigate(&goal);
  }

  // (m/s, rad/s, whether it drives to a target).
  py::tuple step(double time, const Triple& pose, const Pair& velocity, const Doubles& obstacles) {
    set_time(time);
    robot_.pose = {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)};
    robot_.velocity = velocity;
    robot_.obstacles.clear();
    for (py::ssize_t i = 0; i < obstacles.shape(0); ++i) {
      const double dx = obstacles.at(i, 0) - robot_.pose.x, dy = obstacles.at(i, 1) - robot_.pose.y;
      const double c = std::cos(robot_.pose.phi), s = std::sin(robot_.pose.phi);
      robot_.obstacles.insertPoint(static_cast<float>(c * dx + s * dy), static_cast<float>(-s * dx + c * dy), 0.0F);
    }
    navigator_.navigationStep();
    const bool drives = navigator_.getCurrentState() == Navigator_::NAVIGATING;
    if (!drives) robot_.commanded = {0.0, 0.0};
    return py::make_tuple(robot_.commanded.first, robot_.commanded.second, drives);
  }

 private:
  using Navigator_ = mrpt::nav::CReactiveNavigationSystem;

  // MRPT's time never goes back, as ours does between scenes.
  void set_time(double time) {
    if (time + offset_ < robot_.time) offset_ = robot_.time + kBetween - time;
    robot_.time = time + offset_;
    mrpt::Clock::setSimulatedTime(mrpt::Clock::fromDouble(kEpoch + robot_.time));
  }

  Robot robot_;
  Navigator_ navigator_;
  double offset_ = 0.0;  // s
};

}  // namespace

PYBIND11_MODULE(_mrpt_peer, module) {
  module.doc() = "MRPT's CReactiveNavigationSystem. SI units, poses as (x, y, yaw); settings as in its files.";
  py::class_<Navigator>(module, "Navigator")
      .def(py::init<const std::string&>(), py::arg("settings"))
      .def("go", &Navigator::go, py::arg("target"), py::arg("allowed"), py::arg("speed"))
      .def("step", &Navigator::step, py::arg("time"), py::arg("pose"), py::arg("velocity"), py::arg("obstacles"));
}
