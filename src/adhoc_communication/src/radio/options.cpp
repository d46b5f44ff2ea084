#include "radio/options.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <set>
#include <stdexcept>

#include "radio/wall_image.hpp"
#include "robot_name.hpp"
#include "texts.hpp"

namespace adhoc_communication {

const char* const kRadioUsage =
    "usage: radio [--interface ROBOT=INTERFACE]... [--hub PATH] [OPTION VALUE]...\n"
    "Carries frames between the robots of one computer as a radio would. Options, with their defaults:\n"
    "\n"
    "who hears whom\n"
    "  --range 10               metres; not together with the next four\n"
    "  --p-tx 15                log-distance path loss, if any of these four is given: transmit power, dBm\n"
    "  --p-thres -75            weakest power received, dBm\n"
    "  --l-0-model 33           path loss at 1 m, dB\n"
    "  --n-model 4              path loss exponent\n"
    "  --walls FILE             binary PGM image (P5), dark is wall\n"
    "  --walls-resolution 0.05  metres per pixel\n"
    "  --walls-origin 0,0       X,Y of its lower left corner, metres\n"
    "  --wall-attenuation 10    dB for each wall crossed\n"
    "  --shadowing 0            standard deviation, dB\n"
    "  --shadowing-distance 5   metres over which it changes\n"
    "  --loss 0                 of each frame on each link, 0 to 1\n"
    "  --burst-good 0           seconds for which a link is good, on average,\n"
    "  --burst-bad 0            and bad; 0: never\n"
    "  --burst-loss 1           of each frame while it is bad, 0 to 1\n"
    "  --interference-period 0  seconds from one begin of interference to the next,\n"
    "  --interference 0         and how long it destroys all frames from then on; 0: never\n"
    "air time\n"
    "  --bit-rate 50e6          bit/s\n"
    "  --broadcast-rate 0       bit/s of frames for all; 0: as the bit rate\n"
    "  --unicast-rates false    true: a frame for one robot goes at 6 to 54 Mbit/s, the better it hears the faster\n"
    "  --unicast-retries 0      of the link layer, with contention\n"
    "  --shared false           true: all robots take turns on one channel; otherwise each sends when it likes\n"
    "  --spatial-reuse false    true: with --shared, frames that disturb each other nowhere share a turn\n"
    "  --contention false       true: one channel with carrier sense, half duplex and collisions\n"
    "  --capture 10             dB by which a frame has to be stronger than another to survive it\n"
    "  --delay 0                seconds from the end of a frame on the air until its receiver has it\n"
    "  --jitter 0               seconds that it may take longer, at random\n"
    "  --jitter-reorders false  true: later frames may come before earlier ones\n"
    "  --rtf 1                  real-time factor of the simulation: the bit rate is as much higher\n"
    "operation\n"
    "  --seed 1                 of everything random\n"
    "  --control PATH           socket (SOCK_SEQPACKET) for commands, one per line: position NAME X Y | loss P |\n"
    "                           range R | link A B P | down NAME | up NAME | statistics\n"
    "  --statistics FILE        counters as JSON, written at the end\n";

namespace {

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

double number(const std::string& option, const std::string& text, double low, double high) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value < low || value > high) {
    throw std::invalid_argument(option + " " + text + ": a number from " + brief(low) + " to " + brief(high) +
                                " is needed");
  }
  return value;
}

std::uint64_t whole_number(const std::string& option, const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument(option + " " + text + ": a whole number is needed");
  }
  return value;
}

bool truth(const std::string& option, const std::string& text) {
  if (text != "true" && text != "false") throw std::invalid_argument(option + " " + text + ": true or false is needed");
  return text == "true";
}

Position position(const std::string& option, const std::string& text) {
  const auto comma = text.find(',');
  if (comma == std::string::npos) throw std::invalid_argument(option + " " + text + ": the form X,Y is needed");
  return {number(option, text.substr(0, comma), -1e9, 1e9), number(option, text.substr(comma + 1), -1e9, 1e9)};
}

void add_interface(RadioOptions& options, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw std::invalid_argument("--interface " + text + ": the form ROBOT=INTERFACE is needed");
  }
  const std::string robot = text.substr(0, equals);
  if (!is_robot_name(robot)) throw std::invalid_argument("--interface " + text + ": " + no_name_text(robot));
  if (!options.interfaces.emplace(robot, text.substr(equals + 1)).second) {
    throw std::invalid_argument("--interface " + text + ": this robot is named twice");
  }
}

struct CommandLine {
  RadioOptions options;
  PathLoss path_loss;
  std::string wall_image;
  std::set<std::string> given;  ///< names of options

  bool has_any(const std::set<std::string>& names) const {
    for (const std::string& name : names) {
      if (given.count(name) != 0) return true;
    }
    return false;
  }
};

using Setter = std::function<void(CommandLine&, const std::string& option, const std::string& value)>;

/// Stores a number from `low` to `high` where `place` says.
template <typename Place>
Setter numeric(Place place, double low, double high) {
  return [place, low, high](CommandLine& line, const std::string& option, const std::string& value) {
    place(line) = number(option, value, low, high);
  };
}

/// Seconds, up to an hour.
template <typename Place>
Setter duration(Place place) {
  return [place](CommandLine& line, const std::string& option, const std::string& value) {
    place(line) = Time(std::llround(1e9 * number(option, value, 0, 3600)));
  };
}

template <typename Place>
Setter textual(Place place) {
  return [place](CommandLine& line, const std::string&, const std::string& value) { place(line) = value; };
}

template <typename Place>
Setter logical(Place place) {
  return [place](CommandLine& line, const std::string& option, const std::string& value) {
    place(line) = truth(option, value);
  };
}

const std::set<std::string> kPathLossOptions = {"--p-tx", "--p-thres", "--l-0-model", "--n-model"};
const std::set<std::string> kWallOptions = {"--walls-resolution", "--walls-origin", "--wall-attenuation"};

const std::map<std::string, Setter>& setters() {
  using Line = CommandLine;
  const Setter add = [](Line& line, const std::string&, const std::string& value) {
    add_interface(line.options, value);
  };
  const Setter set_origin = [](Line& line, const std::string& option, const std::string& value) {
    line.options.medium.walls.origin = position(option, value);
  };
  const Setter set_unicast_rates = [](Line& line, const std::string& option, const std::string& value) {
    line.options.medium.rates.unicast = truth(option, value) ? ofdm_rates() : std::vector<Rate>();
  };
  const Setter set_unicast_retries = [](Line& line, const std::string& option, const std::string& value) {
    line.options.medium.rates.unicast_retries = static_cast<int>(number(option, value, 0, 100));
  };
  const Setter set_seed = [](Line& line, const std::string& option, const std::string& value) {
    line.options.seed = whole_number(option, value);
  };
  static const std::map<std::string, Setter> table = {
      {"--interface", add},
      {"--hub", textual([](Line & l) -> auto& { return l.options.hub; })},
      {"--range", numeric(
                      [](Line & l) -> auto& { return l.options.medium.range; }, 0.0, 1e9)},
      {"--p-tx", numeric(
                     [](Line & l) -> auto& { return l.path_loss.p_tx; }, -100, 100)},
      {"--p-thres", numeric(
                        [](Line & l) -> auto& { return l.path_loss.p_thres; }, -200, 100)},
      {"--l-0-model", numeric(
                          [](Line & l) -> auto& { return l.path_loss.l_0_model; }, 0, 200)},
      {"--n-model", numeric(
                        [](Line & l) -> auto& { return l.path_loss.n_model; }, 0, 20)},
      {"--walls", textual([](Line & l) -> auto& { return l.wall_image; })},
      {"--walls-resolution", numeric(
                                 [](Line & l) -> auto& { return l.options.medium.walls.resolution; }, 0.001, 1000)},
      {"--walls-origin", set_origin},
      {"--wall-attenuation", numeric(
                                 [](Line & l) -> auto& { return l.options.medium.wall_attenuation; }, 0, 1000)},
      {"--shadowing", numeric(
                          [](Line & l) -> auto& { return l.options.medium.shadowing.deviation; }, 0, 50)},
      {"--shadowing-distance", numeric(
                                   [](Line & l) -> auto& { return l.options.medium.shadowing.distance; }, 0.01, 1e6)},
      {"--loss", numeric(
                     [](Line & l) -> auto& { return l.options.medium.loss; }, 0.0, 1.0)},
      {"--burst-good", duration([](Line & l) -> auto& { return l.options.medium.bursts.good; })},
      {"--burst-bad", duration([](Line & l) -> auto& { return l.options.medium.bursts.bad; })},
      {"--burst-loss", numeric(
                           [](Line & l) -> auto& { return l.options.medium.bursts.loss; }, 0.0, 1.0)},
      {"--interference-period", duration([](Line & l) -> auto& { return l.options.medium.interference.period; })},
      {"--interference", duration([](Line & l) -> auto& { return l.options.medium.interference.duration; })},
      {"--delay", duration([](Line & l) -> auto& { return l.options.medium.delay.fixed; })},
      {"--jitter", duration([](Line & l) -> auto& { return l.options.medium.delay.jitter; })},
      {"--jitter-reorders", logical([](Line & l) -> auto& { return l.options.medium.delay.reorders; })},
      {"--bit-rate", numeric(
                         [](Line & l) -> auto& { return l.options.medium.bit_rate; }, 1e3, 1e12)},
      {"--broadcast-rate", numeric(
                               [](Line & l) -> auto& { return l.options.medium.rates.broadcast; }, 0, 1e12)},
      {"--unicast-rates", set_unicast_rates},
      {"--unicast-retries", set_unicast_retries},
      {"--shared", logical([](Line & l) -> auto& { return l.options.medium.shared; })},
      {"--spatial-reuse", logical([](Line & l) -> auto& { return l.options.medium.spatial_reuse; })},
      {"--contention", logical([](Line & l) -> auto& { return l.options.medium.contention; })},
      {"--capture", numeric(
                        [](Line & l) -> auto& { return l.options.medium.capture; }, 0, 200)},
      {"--rtf", numeric(
                    [](Line & l) -> auto& { return l.options.rtf; }, 0.001, 1000)},
      {"--seed", set_seed},
      {"--control", textual([](Line & l) -> auto& { return l.options.control; })},
      {"--statistics", textual([](Line & l) -> auto& { return l.options.statistics; })},
  };
  return table;
}

void set(CommandLine& line, const std::string& option, const std::string& value) {
  const auto setter = setters().find(option);
  if (setter == setters().end()) throw std::invalid_argument("option " + option + " is unknown");
  setter->second(line, option, value);
  line.given.insert(option);
}

void check_combination(const CommandLine& line) {
  if (line.options.interfaces.empty() && line.options.hub.empty()) {
    throw std::invalid_argument("nothing to connect: give --interface ROBOT=INTERFACE or --hub PATH");
  }
  if (line.has_any({"--range"}) && line.has_any(kPathLossOptions)) {
    throw std::invalid_argument(
        "--range and the path loss (--p-tx, --p-thres, --l-0-model, --n-model) both decide who "
        "hears whom: give one of them");
  }
  if (line.wall_image.empty() && line.has_any(kWallOptions)) {
    throw std::invalid_argument("options of walls were given, but no --walls FILE");
  }
  if (line.options.medium.shared && line.options.medium.contention) {
    throw std::invalid_argument("--shared true and --contention true exclude each other");
  }
  if (line.options.medium.spatial_reuse && !line.options.medium.shared) {
    throw std::invalid_argument("--spatial-reuse needs --shared true");
  }
  if (line.options.medium.interference.duration > line.options.medium.interference.period) {
    throw std::invalid_argument("--interference is longer than --interference-period");
  }
  if (line.options.medium.rates.unicast_retries > 0 && !line.options.medium.contention) {
    throw std::invalid_argument("--unicast-retries needs --contention true");
  }
}

RadioOptions completed(CommandLine line) {
  check_combination(line);
  if (line.has_any(kPathLossOptions)) line.options.medium.path_loss = line.path_loss;
  if (!line.wall_image.empty()) read_wall_image(line.wall_image, line.options.medium.walls);
  return line.options;
}

}  // namespace

RadioOptions parse_radio_options(int argc, char** argv) {
  CommandLine line;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option.compare(0, 2, "__") == 0) continue;  // roslaunch adds __name:=... and __log:=...
    if (option == "--help" || option == "-h") {
      line.options.help = true;
      return line.options;
    }
    if (i + 1 == argc) throw std::invalid_argument("option " + option + " needs a value");
    set(line, option, argv[++i]);
  }
  return completed(std::move(line));
}

MediumOptions in_real_time(MediumOptions medium, double rtf) {
  const auto scaled = [rtf](Time time) { return Time(std::llround(static_cast<double>(time.count()) / rtf)); };
  medium.bit_rate *= rtf;
  medium.rates.broadcast *= rtf;
  for (Rate& rate : medium.rates.unicast) rate.bit_rate *= rtf;
  medium.rates.acknowledgment = scaled(medium.rates.acknowledgment);
  medium.frame_overhead = scaled(medium.frame_overhead);
  medium.slot = scaled(medium.slot);
  for (Time* time : {&medium.bursts.good, &medium.bursts.bad, &medium.delay.fixed, &medium.delay.jitter,
                     &medium.interference.period, &medium.interference.duration}) {
    *time = scaled(*time);
  }
  return medium;
}

}  // namespace adhoc_communication
