// Python module mr_experiments._slam_peers: MRPT's map builders behind one interface, to compare SLAM with.
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/slam/CMetricMapBuilderICP.h>
#include <mrpt/slam/CMetricMapBuilderRBPF.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace py = pybind11;
using namespace mrpt::slam;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::poses::CPose2D;

namespace {

constexpr char kSection[] = "MappingApplication";
constexpr double kEpoch = 1.0;  // s: MRPT takes time 0 for none
// A scan of less is passed over: nothing to align.
constexpr std::size_t kFewestHits = 20;

using PoseTuple = std::tuple<double, double, double>;
using Ranges = py::array_t<float, py::array::c_style | py::array::forcecast>;

CPose2D to_pose(const PoseTuple& pose) { return {std::get<0>(pose), std::get<1>(pose), std::get<2>(pose)}; }

PoseTuple to_tuple(const CPose2D& pose) { return {pose.x(), pose.y(), pose.phi()}; }

CObservation2DRangeScan::Ptr to_scan(const Ranges& ranges, const PoseTuple& mount, double angle_min, double increment,
                                     double range_min, double range_max) {
  const auto size = static_cast<std::size_t>(ranges.size());
  auto scan = CObservation2DRangeScan::Create();
  const double aperture = increment * static_cast<double>(size - 1);
  scan->sensorLabel = "laser";
  scan->aperture = static_cast<float>(aperture);
  scan->maxRange = static_cast<float>(range_max);
  scan->rightToLeft = true;
  const CPose2D middle(0.0, 0.0, angle_min + 0.5 * aperture);
  scan->sensorPose = mrpt::poses::CPose3D(to_pose(mount) + middle);
  scan->resizeScan(size);
  for (std::size_t i = 0; i < size; ++i) {
    const float range = ranges.data()[i];
    const bool hit = range >= range_min && range < range_max - 1e-3;  // false for NaN
    scan->setScanRange(i, hit ? range : 0.0f);
    scan->setScanRangeValidity(i, hit);
  }
  return scan;
}

std::size_t hits(const CObservation2DRangeScan& scan) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < scan.getScanSize(); ++i) count += scan.getScanRangeValidity(i) ? 1 : 0;
  return count;
}

class Peer {
 public:
  explicit Peer(std::unique_ptr<CMetricMapBuilder> builder) : builder_(std::move(builder)) { builder_->initialize(); }

  // The pose in the frame of the start, after a scan taken at `odometry`.
  PoseTuple process(const Ranges& ranges, const PoseTuple& odometry, const PoseTuple& mount, double angle_min,
                    double angle_increment, double range_min, double range_max, double time) {
    const auto moment = mrpt::Clock::fromDouble(kEpoch + time);
    auto scan = to_scan(ranges, mount, angle_min, angle_increment, range_min, range_max);
    scan->timestamp = moment;
    const CPose2D now = to_pose(odometry);
    if (odometry_ && hits(*scan) < kFewestHits) return to_tuple(pose() + (now - *odometry_));
    CActionRobotMovement2D movement;
    movement.computeFromOdometry(now - odometry_.value_or(now), {});
    movement.timestamp = moment;
    odometry_ = now;
    mrpt::obs::CActionCollection actions;
    actions.insert(movement);
    mrpt::obs::CSensoryFrame observations;
    observations.insert(scan);
    builder_->processActionObservation(actions, observations);
    return to_tuple(pose());
  }

  // Cells int8 (rows, columns), 0 free to 100 occupied, -1 unknown; the lower left corner in m; m per cell.
  py::tuple occupancy() const {
    const auto grid = builder_->getCurrentlyBuiltMetricMap()->mapByClass<mrpt::maps::COccupancyGridMap2D>();
    const int width = static_cast<int>(grid->getSizeX()), height = static_cast<int>(grid->getSizeY());
    py::array_t<int8_t> cells({height, width});
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const float free = grid->getCell(x, y);
        cells.mutable_at(y, x) = free == 0.5f ? int8_t{-1} : static_cast<int8_t>(std::lround(100.0f * (1.0f - free)));
      }
    }
    return py::make_tuple(cells, grid->getXMin(), grid->getYMin(), grid->getResolution());
  }

 private:
  CPose2D pose() const { return CPose2D(builder_->getCurrentPoseEstimation()->getMeanVal()); }

  std::unique_ptr<CMetricMapBuilder> builder_;
  std::optional<CPose2D> odometry_;  // at the last scan
};

std::unique_ptr<Peer> icp(const std::string& settings) {
  const mrpt::config::CConfigFileMemory file(settings);
  auto builder = std::make_unique<CMetricMapBuilderICP>();
  builder->ICP_options.loadFromConfigFile(file, kSection);
  builder->ICP_params.loadFromConfigFile(file, "ICP");
  builder->setVerbosityLevel(mrpt::system::LVL_ERROR);
  return std::make_unique<Peer>(std::move(builder));
}

// The generator of random numbers is MRPT's, one for the process: filters run one after the other.
std::unique_ptr<Peer> rbpf(const std::string& settings, unsigned int seed) {
  mrpt::random::getRandomGenerator().randomize(seed);
  const mrpt::config::CConfigFileMemory file(settings);
  CMetricMapBuilderRBPF::TConstructionOptions options;
  options.loadFromConfigFile(file, kSection);
  options.verbosity_level = mrpt::system::LVL_ERROR;
  auto builder = std::make_unique<CMetricMapBuilderRBPF>(options);
  builder->mapPDF.setVerbosityLevel(mrpt::system::LVL_ERROR);
  return std::make_unique<Peer>(std::move(builder));
}

}  // namespace

PYBIND11_MODULE(_slam_peers, module) {
  module.doc() = "MRPT's map builders. SI units, poses as (x, y, yaw); settings as in MRPT's configuration files.";
  py::class_<Peer>(module, "Peer").def("process", &Peer::process).def("occupancy", &Peer::occupancy);
  module.def("icp", &icp, py::arg("settings"));
  module.def("rbpf", &rbpf, py::arg("settings"), py::arg("seed"));
}
