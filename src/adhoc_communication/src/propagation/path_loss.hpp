// Log-distance path loss: how strong a frame arrives.
#pragma once

namespace adhoc_communication {

/// The defaults give a range of 26.6 m.
struct PathLoss {
  double p_tx = 15.0;       ///< transmit power, dBm
  double p_thres = -75.0;   ///< weakest power received, dBm
  double l_0_model = 33.0;  ///< path loss at 1 m, dB
  double n_model = 4.0;     ///< path loss exponent
};

/// p_tx - (l_0_model + 10 n_model log10(d)), dBm at a distance of d metres; without limit in the same place.
double received_power(const PathLoss& model, double distance);

/// The distance at which `power` dBm are received.
double distance_of_power(const PathLoss& model, double power);

}  // namespace adhoc_communication
