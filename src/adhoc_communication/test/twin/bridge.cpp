// The Python module twin_bridge: robots with this engine and stations without one on the same simulated radio, in
// virtual time. Times are int nanoseconds.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "link/capture_file.hpp"
#include "simulation/team.hpp"

namespace py = pybind11;

namespace adhoc_communication {
namespace {

Bytes bytes_of(const py::bytes& octets) {
  const std::string text = octets;
  return {text.begin(), text.end()};
}

template <typename Octets>
py::bytes python_bytes(const Octets& octets) {
  return {reinterpret_cast<const char*>(octets.data()), octets.size()};
}

template <typename Octets>
Octets exactly(const py::bytes& octets) {
  const std::string text = octets;
  Octets value{};
  if (text.size() != value.size()) throw std::invalid_argument(std::to_string(value.size()) + " octets are needed");
  std::copy(text.begin(), text.end(), value.begin());
  return value;
}

class Bridge {
 public:
  Bridge(double loss, std::uint64_t seed, const std::optional<py::bytes>& key,
         const std::optional<std::string>& capture)
      : team_(medium_options(loss), seed) {
    if (key) keys_.push_back(exactly<TeamKey>(*key));
    if (capture) capture_ = std::make_unique<CaptureFile>(*capture, 0);
    team_.on_frame = [this](Medium::Node node, const Frame& frame) {
      if (stations_.count(node) != 0) heard_.emplace_back(node, frame);
    };
    team_.on_transmission = [this](std::size_t, const Frame& frame) { record(frame); };
  }

  std::size_t add_robot(const std::string& name, double x, bool joins_groups, int mtu) {
    EngineOptions options;
    options.mtu = mtu;
    options.join_groups_automatically = joins_groups;
    options.robot_name = name;
    options.keys = keys_;
    return team_.add(options, x);
  }

  /// Returns the number that station frames carry.
  Medium::Node add_station(const std::string& name, const py::bytes& address, double x) {
    const Medium::Node node = team_.medium().add_node(name, exactly<MacAddress>(address));
    team_.medium().set_position(node, x, 0.0);
    stations_[node] = exactly<MacAddress>(address);
    return node;
  }

  void transmit(Medium::Node station, const py::bytes& destination, const py::bytes& octets) {
    const Frame frame{exactly<MacAddress>(destination), stations_.at(station), bytes_of(octets)};
    record(frame);
    team_.medium().transmit(station, frame, team_.now());
  }

  /// Runs to `until`, or to the first moment at which a station hears something; returns what was heard.
  std::vector<std::tuple<Medium::Node, py::bytes, py::bytes, py::bytes>> advance(std::int64_t until) {
    team_.run_until_done([this] { return !heard_.empty(); }, std::max(Time(until) - team_.now(), Time(0)));
    std::vector<std::tuple<Medium::Node, py::bytes, py::bytes, py::bytes>> result;
    for (const auto& [node, frame] : std::exchange(heard_, {})) {
      result.emplace_back(node, python_bytes(frame.destination), python_bytes(frame.source), python_bytes(frame.bytes));
    }
    return result;
  }

  SendId send(std::size_t robot, const std::string& destination, const py::bytes& payload) {
    return team_.send(robot, destination, bytes_of(payload));
  }
  /// Nothing while it has not ended.
  std::optional<std::pair<bool, std::string>> end_of(std::size_t robot, SendId id) const {
    const SendFinished* end = team_.finished(robot, id);
    return end == nullptr ? std::nullopt : std::optional(std::pair(end->delivered, end->reason));
  }
  /// Source, topic, payload and hops of each packet.
  std::vector<std::tuple<std::string, std::string, py::bytes, int>> received(std::size_t robot) {
    std::vector<std::tuple<std::string, std::string, py::bytes, int>> result;
    for (const Team::Received& received : team_.received(robot)) {
      const PacketReceived& packet = received.packet;
      result.emplace_back(packet.source, packet.topic, python_bytes(packet.payload), packet.hops);
    }
    return result;
  }
  /// Frames that the robot has dropped, by reason.
  std::map<std::string, std::uint64_t> dropped(std::size_t robot) {
    const FramesDropped& dropped = team_.engine(robot).statistics().frames_dropped;
    return {{"malformed", dropped.malformed}, {"unsealed", dropped.unsealed}, {"no_key", dropped.no_key},
            {"forged", dropped.forged},       {"replayed", dropped.replayed}, {"reflected", dropped.reflected},
            {"unproven", dropped.unproven}};
  }
  std::vector<std::string> neighbors(std::size_t robot) { return team_.engine(robot).neighbors(); }
  void kill(std::size_t robot) { team_.kill(robot); }
  void restart(std::size_t robot) { team_.restart(robot); }
  std::int64_t now() const { return team_.now().count(); }
  std::uint64_t trace_hash() const { return team_.trace_hash(); }

 private:
  static MediumOptions medium_options(double loss) {
    MediumOptions options;
    options.loss = loss;
    return options;
  }
  void record(const Frame& frame) {
    if (capture_) capture_->add(frame, team_.now());
  }

  Team team_;
  std::vector<TeamKey> keys_;
  std::map<Medium::Node, MacAddress> stations_;
  std::vector<std::pair<Medium::Node, Frame>> heard_;
  std::unique_ptr<CaptureFile> capture_;
};

}  // namespace

PYBIND11_MODULE(twin_bridge, module) {
  py::class_<Bridge>(module, "Bridge")
      .def(py::init<double, std::uint64_t, std::optional<py::bytes>, std::optional<std::string>>(), py::arg("loss"),
           py::arg("seed"), py::arg("key") = std::nullopt, py::arg("capture") = std::nullopt)
      .def("add_robot", &Bridge::add_robot)
      .def("add_station", &Bridge::add_station)
      .def("transmit", &Bridge::transmit)
      .def("advance", &Bridge::advance)
      .def("send", &Bridge::send)
      .def("end_of", &Bridge::end_of)
      .def("received", &Bridge::received)
      .def("dropped", &Bridge::dropped)
      .def("neighbors", &Bridge::neighbors)
      .def("kill", &Bridge::kill)
      .def("restart", &Bridge::restart)
      .def_property_readonly("now", &Bridge::now)
      .def_property_readonly("trace_hash", &Bridge::trace_hash);
}

}  // namespace adhoc_communication
