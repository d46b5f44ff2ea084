// At which bit rate a frame goes. As on Wi-Fi, one for everybody takes a slow rate that all understand, one for a
// single robot the fastest that this robot hears.
#pragma once

#include <optional>
#include <vector>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

struct Rate {
  double bit_rate = 0.0;  ///< bit/s
  double margin = 0.0;    ///< dB by which the power received has to exceed the weakest one received at all
};

struct RateOptions {
  double broadcast = 0.0;     ///< bit/s of frames for everybody; 0: that of the medium
  std::vector<Rate> unicast;  ///< rising in both; the last one whose margin is there. Empty: that of the medium
  int unicast_retries = 0;    ///< of a frame that its receiver did not get
  /// Air time of the link layer's acknowledgment, or of waiting for it, while it repeats.
  Time acknowledgment = std::chrono::microseconds(44);
};

/// The rates of 802.11g. Margins follow from the least sensitivities that IEEE 802.11 asks of a receiver in a channel
/// of 20 MHz: -82 dBm at 6 Mbit/s to -65 dBm at 54.
std::vector<Rate> ofdm_rates();

/// Of a frame whose receiver hears it with that margin; nothing: it does not hear it at all.
double unicast_bit_rate(const std::vector<Rate>& rates, std::optional<double> margin);

}  // namespace adhoc_communication
