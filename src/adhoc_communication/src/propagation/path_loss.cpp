#include "propagation/path_loss.hpp"

#include <cmath>
#include <limits>

namespace adhoc_communication {

double received_power(const PathLoss& model, double distance) {
  if (distance <= 0.0) return std::numeric_limits<double>::infinity();
  return model.p_tx - (model.l_0_model + 10.0 * model.n_model * std::log10(distance));
}

double distance_of_power(const PathLoss& model, double power) {
  const double margin = model.p_tx - model.l_0_model - power;
  if (model.n_model == 0.0) return margin < 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  return std::pow(10.0, margin / (10.0 * model.n_model));
}

}  // namespace adhoc_communication
