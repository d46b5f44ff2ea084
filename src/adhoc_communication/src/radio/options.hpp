// Command line of the radio daemon.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace adhoc_communication {

struct RadioOptions {
  std::map<std::string, std::string> interfaces;  ///< robot name -> network interface that leads to it
  std::string hub;                                ///< path of the socket for HubLink clients, empty for none
  double range = 10.0;                            ///< metres
  double loss = 0.0;                              ///< of each frame on each link, 0..1
  double bit_rate = 50e6;                         ///< bit/s
  bool shared = false;                            ///< all robots take turns on one channel
  std::uint64_t seed = 1;
  std::string control;     ///< path of the control socket, empty for none
  std::string statistics;  ///< file written at the end, empty for none
  bool help = false;
};

extern const char* const kRadioUsage;

/// Throws std::invalid_argument with one sentence that names the option.
RadioOptions parse_radio_options(int argc, char** argv);

}  // namespace adhoc_communication
