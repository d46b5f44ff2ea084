#include "medium/rates.hpp"

namespace adhoc_communication {

std::vector<Rate> ofdm_rates() {
  return {{6e6, 0}, {9e6, 1}, {12e6, 3}, {18e6, 5}, {24e6, 8}, {36e6, 12}, {48e6, 16}, {54e6, 17}};
}

double unicast_bit_rate(const std::vector<Rate>& rates, std::optional<double> margin) {
  double best = rates.front().bit_rate;
  for (const Rate& rate : rates) {
    if (margin && *margin >= rate.margin) best = rate.bit_rate;
  }
  return best;
}

}  // namespace adhoc_communication
