#include "radio/control.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "robot_name.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMaxNodes = 1000;
constexpr double kFarthest = 1e9;  // metres

bool is_coordinate(double value) { return std::abs(value) <= kFarthest; }
bool is_probability(double value) { return value >= 0.0 && value <= 1.0; }

std::string refuse(const std::string& line) {
  return "command '" + line +
         "' is not one of: position NAME X Y | loss P | range R | link A B P | down NAME | up NAME | statistics";
}

void write_counters(std::ostream& out, const Medium::Counters& counters) {
  out << "\"frames\": " << counters.frames << ", \"bytes\": " << counters.octets
      << ", \"delivered\": " << counters.delivered << ", \"lost\": " << counters.lost
      << ", \"collided\": " << counters.collided << ", \"unheard\": " << counters.unheard
      << ", \"discarded\": " << counters.discarded << ", \"repeated\": " << counters.repeated
      << ", \"air_time\": " << std::chrono::duration<double>(counters.air_time).count();
}

/// The rest of the line has to be empty, so that a mistyped command is not half obeyed.
bool is_at_end(std::istringstream& words) {
  words >> std::ws;
  return words.eof();
}

/// Throws std::invalid_argument for a robot that cannot be.
std::string obey(const std::string& line, Medium& medium, Time now) {
  std::istringstream words(line);
  std::string command, name, other;
  double x = 0.0, y = 0.0;
  words >> command;
  if (command == "range" && medium.options().path_loss) {
    return "command '" + line + "' has no effect: path loss decides who hears whom";
  }
  if (command == "position" && words >> name >> x >> y && is_at_end(words) && is_coordinate(x) && is_coordinate(y)) {
    medium.set_position(node_named(medium, name), x, y);
  } else if (command == "loss" && words >> x && is_at_end(words) && is_probability(x)) {
    medium.set_loss(x);
  } else if (command == "range" && words >> x && is_at_end(words) && x >= 0.0) {
    medium.set_range(x);
  } else if (command == "link" && words >> name >> other >> x && is_at_end(words) && is_probability(x)) {
    medium.set_link_loss(node_named(medium, name), node_named(medium, other), x);
  } else if ((command == "down" || command == "up") && words >> name && is_at_end(words)) {
    medium.set_up(node_named(medium, name), command == "up", now);
  } else {
    return refuse(line);
  }
  return "";
}

}  // namespace

Medium::Node node_named(Medium& medium, const std::string& name) {
  if (const auto node = medium.find(name)) return *node;
  if (!is_robot_name(name)) throw std::invalid_argument(no_name_text(name));
  if (medium.node_count() >= kMaxNodes) {
    throw std::invalid_argument("the radio knows " + std::to_string(kMaxNodes) + " robots and takes no more: '" + name +
                                "' is too many");
  }
  return medium.add_node(name);
}

std::string carry_out(const std::string& line, Medium& medium, Time now) {
  try {
    return obey(line, medium, now);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

std::string statistics_json(const Medium& medium) {
  std::ostringstream out;
  out << "{";
  write_counters(out, medium.counters());
  out << ", \"robots\": {";
  for (Medium::Node node = 0; node < medium.node_count(); ++node) {
    out << (node == 0 ? "" : ", ") << '"' << medium.name(node) << "\": {";
    write_counters(out, medium.counters(node));
    out << "}";
  }
  out << "}}\n";
  return out.str();
}

}  // namespace adhoc_communication
