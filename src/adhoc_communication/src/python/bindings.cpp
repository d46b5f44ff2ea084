// The Python module adhoc_engine: robots' engines on the simulated radio, in virtual time. Times are int nanoseconds.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <stdexcept>

#include "node/message_kinds.hpp"
#include "simulation/team.hpp"

namespace py = pybind11;

namespace adhoc_communication {
namespace {

py::bytes octets(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

Bytes bytes_of(const py::bytes& octets) {
  const std::string text = octets;
  return {text.begin(), text.end()};
}

using RasterOfWalls = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

Walls walls_of(const RasterOfWalls& cells, double resolution, const std::pair<double, double>& origin) {
  if (cells.ndim() != 2) throw std::invalid_argument("walls: an array of rows and columns is needed");
  Walls walls;
  walls.cells.assign(cells.data(), cells.data() + cells.size());
  walls.width = static_cast<std::size_t>(cells.shape(1));
  walls.resolution = resolution;
  walls.origin = {origin.first, origin.second};
  return walls;
}

/// A team whose events are collected until the host takes them.
class PythonTeam {
 public:
  PythonTeam(const MediumOptions& medium, std::uint64_t seed) : team_(medium, seed) {
    team_.remembers = false;
    team_.on_event = [this](std::size_t robot, const Event& event) {
      if (!std::holds_alternative<NameTaken>(event)) events_.emplace_back(robot, event);
    };
  }

  std::size_t add(EngineOptions options, double x, double y) {
    options.keys = keys_;
    return team_.add(std::move(options), x, y);
  }

  /// Runs to `until`, or to the first moment at which a robot reports something; returns what was reported.
  std::vector<std::pair<std::size_t, Event>> advance(std::int64_t until) {
    {
      const py::gil_scoped_release release;
      team_.run_until_done([this] { return !events_.empty(); }, std::max(Time(until) - team_.now(), Time(0)));
    }
    return std::exchange(events_, {});
  }

  SendId send(std::size_t robot, const std::string& service, const std::string& destination, const std::string& topic,
              const py::bytes& message) {
    const MessageKind& kind = kind_of(service);
    engine(robot);  // which may have been killed
    return team_.send(
        robot, {destination, topic, static_cast<std::uint8_t>(kind.payload_type), bytes_of(message), kind.priority});
  }

  SendId send_message(std::size_t robot, const std::string& destination, const std::string& topic,
                      const std::string& type, const std::string& md5sum, const std::string& definition,
                      const py::bytes& data) {
    const SerializedMessage message{type, md5sum, definition, bytes_of(data)};
    engine(robot);
    return team_.send(robot, any_message_request(destination, topic, message));
  }

  void set_key(const py::bytes& key) {
    const Bytes octets = bytes_of(key);
    TeamKey team_key{};
    if (octets.size() != team_key.size()) throw std::invalid_argument("a team key has 32 octets");
    std::copy(octets.begin(), octets.end(), team_key.begin());
    keys_ = {team_key};
  }

  py::dict statistics(std::size_t robot) {
    const Statistics& statistics = engine(robot).statistics();
    py::dict values;
    values["frames_sent"] = statistics.frames_sent;
    values["bytes_sent"] = statistics.bytes_sent;
    values["frames_received"] = statistics.frames_received;
    values["bytes_received"] = statistics.bytes_received;
    values["packets_sent"] = statistics.packets_sent;
    values["packets_failed"] = statistics.packets_failed;
    values["packets_received_by_hops"] = statistics.packets_received_by_hops;
    return values;
  }

  Team& team() { return team_; }
  /// Throws std::out_of_range for a robot that there is not, std::invalid_argument for one that was killed.
  Engine& engine(std::size_t robot) {
    if (!team_.alive(robot)) throw std::invalid_argument("robot " + std::to_string(robot) + " was killed");
    return team_.engine(robot);
  }

 private:
  Team team_;
  std::vector<TeamKey> keys_;
  std::vector<std::pair<std::size_t, Event>> events_;
};

void bind_events(py::module& module) {
  py::class_<PacketReceived>(module, "PacketReceived")
      .def_readonly("source", &PacketReceived::source)
      .def_readonly("group", &PacketReceived::group)
      .def_readonly("topic", &PacketReceived::topic)
      .def_readonly("hops", &PacketReceived::hops)
      .def("message", [](const PacketReceived& packet) {
        const SerializedMessage message = decode(packet);
        return std::pair(message.type, octets(message.bytes));
      });
  py::class_<SendFinished>(module, "SendFinished")
      .def_readonly("id", &SendFinished::id)
      .def_readonly("delivered", &SendFinished::delivered)
      .def_readonly("reason", &SendFinished::reason);
  py::class_<RobotAppeared>(module, "RobotAppeared").def_readonly("robot", &RobotAppeared::robot);
  py::class_<RobotLost>(module, "RobotLost").def_readonly("robot", &RobotLost::robot);
  py::class_<GroupChangeFinished>(module, "GroupChangeFinished")
      .def_readonly("group", &GroupChangeFinished::group)
      .def_readonly("joined", &GroupChangeFinished::joined)
      .def_readonly("succeeded", &GroupChangeFinished::succeeded)
      .def_readonly("reason", &GroupChangeFinished::reason);
}

void bind_options(py::module& module) {
  py::class_<MediumOptions>(module, "MediumOptions")
      .def(py::init<>())
      .def_readwrite("range", &MediumOptions::range)
      .def_readwrite("loss", &MediumOptions::loss)
      .def_readwrite("bit_rate", &MediumOptions::bit_rate)
      .def_readwrite("shared", &MediumOptions::shared)
      .def_readwrite("contention", &MediumOptions::contention)
      .def_readwrite("wall_attenuation", &MediumOptions::wall_attenuation)
      .def(
          "set_walls",
          [](MediumOptions& options, const RasterOfWalls& cells, double resolution,
             const std::pair<double, double>& origin) { options.walls = walls_of(cells, resolution, origin); },
          py::arg("cells"), py::arg("resolution"), py::arg("origin"));
  py::class_<EngineOptions>(module, "EngineOptions")
      .def(py::init<>())
      .def_readwrite("robot_name", &EngineOptions::robot_name)
      .def_readwrite("num_link_retrans", &EngineOptions::num_link_retrans)
      .def_readwrite("num_e2e_retrans", &EngineOptions::num_e2e_retrans)
      .def_readwrite("max_frame_size", &EngineOptions::max_frame_size)
      .def_readwrite("max_packet_size", &EngineOptions::max_packet_size)
      .def_readwrite("join_groups_automatically", &EngineOptions::join_groups_automatically);
}

void bind_team(py::module& module) {
  py::class_<PythonTeam>(module, "Team")
      .def(py::init<const MediumOptions&, std::uint64_t>(), py::arg("medium"), py::arg("seed"))
      .def("set_key", &PythonTeam::set_key, py::arg("key"))
      .def("add", &PythonTeam::add, py::arg("options"), py::arg("x"), py::arg("y"))
      .def("advance", &PythonTeam::advance, py::arg("until"))
      .def("send", &PythonTeam::send, py::arg("robot"), py::arg("service"), py::arg("destination"), py::arg("topic"),
           py::arg("message"))
      .def("send_message", &PythonTeam::send_message, py::arg("robot"), py::arg("destination"), py::arg("topic"),
           py::arg("type"), py::arg("md5sum"), py::arg("definition"), py::arg("data"))
      .def(
          "kill", [](PythonTeam& team, std::size_t robot) { team.team().kill(robot); }, py::arg("robot"))
      .def(
          "restart", [](PythonTeam& team, std::size_t robot) { team.team().restart(robot); }, py::arg("robot"))
      .def(
          "set_position",
          [](PythonTeam& team, std::size_t robot, double x, double y) { team.team().set_position(robot, x, y); },
          py::arg("robot"), py::arg("x"), py::arg("y"))
      .def("neighbors", [](PythonTeam& team, std::size_t robot) { return team.engine(robot).neighbors(); })
      .def("robots", [](PythonTeam& team, std::size_t robot) { return team.engine(robot).robots(); })
      .def("statistics", &PythonTeam::statistics, py::arg("robot"))
      .def_property_readonly("now", [](PythonTeam& team) { return team.team().now().count(); })
      .def_property_readonly("trace_hash", [](PythonTeam& team) { return team.team().trace_hash(); });
}

}  // namespace

PYBIND11_MODULE(adhoc_engine, module) {
  module.doc() = "Robots' protocol engines on a simulated radio, in virtual time (int nanoseconds).";
  py::register_exception<PayloadError>(module, "PayloadError", PyExc_ValueError);
  bind_events(module);
  bind_options(module);
  bind_team(module);
}

}  // namespace adhoc_communication
