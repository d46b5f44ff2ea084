// Command line of the radio daemon.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "medium/options.hpp"

namespace adhoc_communication {

struct RadioOptions {
  std::map<std::string, std::string> interfaces;  ///< robot name -> network interface that leads to it
  std::string hub;                                ///< path of the socket for HubLink clients, empty for none
  MediumOptions medium;                           ///< its times are those of the simulated world
  double rtf = 1.0;                               ///< seconds of the simulated world in one second of the clock
  std::uint64_t seed = 1;
  std::string control;     ///< path of the control socket, empty for none
  std::string statistics;  ///< file written at the end, empty for none
  bool help = false;
};

extern const char* const kRadioUsage;

/// Reads the wall image, too. Throws std::invalid_argument with one sentence that names the option.
RadioOptions parse_radio_options(int argc, char** argv);

/// The medium in seconds of the clock: where the world runs at twice the speed, a frame takes half the time.
MediumOptions in_real_time(MediumOptions medium, double rtf);

}  // namespace adhoc_communication
