#include "radio/options.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace adhoc_communication {

const char* const kRadioUsage =
    "usage: radio [--interface ROBOT=INTERFACE]... [--hub PATH] [--range METRES] [--loss P] [--bit-rate BIT/S]\n"
    "             [--shared true|false] [--seed N] [--control PATH] [--statistics FILE]\n"
    "Carries frames between the robots of one computer as a radio would: range, loss and air time.\n"
    "--shared true: all robots take turns on one channel; otherwise each sends when it likes.\n"
    "Control socket (SOCK_SEQPACKET), one command per line: position NAME X Y | loss P | range R | link A B P |\n"
    "down NAME | up NAME | statistics\n";

namespace {

double number(const std::string& option, const std::string& text, double low, double high) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value < low || value > high) {
    throw std::invalid_argument(option + " " + text + ": a number from " + std::to_string(low) + " to " +
                                std::to_string(high) + " is needed");
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

void add_interface(RadioOptions& options, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw std::invalid_argument("--interface " + text + ": the form ROBOT=INTERFACE is needed");
  }
  if (!options.interfaces.emplace(text.substr(0, equals), text.substr(equals + 1)).second) {
    throw std::invalid_argument("--interface " + text + ": this robot is named twice");
  }
}

void set(RadioOptions& options, const std::string& option, const std::string& value) {
  if (option == "--interface") {
    add_interface(options, value);
  } else if (option == "--hub") {
    options.hub = value;
  } else if (option == "--range") {
    options.range = number(option, value, 0.0, 1e9);
  } else if (option == "--loss") {
    options.loss = number(option, value, 0.0, 1.0);
  } else if (option == "--bit-rate") {
    options.bit_rate = number(option, value, 1e3, 1e12);
  } else if (option == "--shared") {
    options.shared = truth(option, value);
  } else if (option == "--seed") {
    options.seed = whole_number(option, value);
  } else if (option == "--control") {
    options.control = value;
  } else if (option == "--statistics") {
    options.statistics = value;
  } else {
    throw std::invalid_argument("option " + option + " is unknown");
  }
}

}  // namespace

RadioOptions parse_radio_options(int argc, char** argv) {
  RadioOptions options;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option.compare(0, 2, "__") == 0) continue;  // roslaunch adds __name:=... and __log:=...
    if (option == "--help" || option == "-h") {
      options.help = true;
      return options;
    }
    if (i + 1 == argc) throw std::invalid_argument("option " + option + " needs a value");
    set(options, option, argv[++i]);
  }
  if (options.interfaces.empty() && options.hub.empty()) {
    throw std::invalid_argument("nothing to connect: give --interface ROBOT=INTERFACE or --hub PATH");
  }
  return options;
}

}  // namespace adhoc_communication
