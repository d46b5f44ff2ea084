#include "medium/options.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace adhoc_communication {
namespace {

void require(bool condition, const std::string& sentence) {
  if (!condition) throw std::invalid_argument(sentence);
}

bool is_rising(const std::vector<Rate>& rates) {
  const auto stands_still = [](const Rate& a, const Rate& b) {
    return a.bit_rate >= b.bit_rate || a.margin >= b.margin;
  };
  return (rates.empty() || rates.front().bit_rate > 0.0) &&
         std::adjacent_find(rates.begin(), rates.end(), stands_still) == rates.end();
}

}  // namespace

const MediumOptions& validated(const MediumOptions& options) {
  require(options.bit_rate > 0.0, "the bit rate of the medium is not above zero");
  require(!options.shared || !options.contention, "the medium is either shared in turns or contended for, not both");
  require(options.shared || !options.spatial_reuse, "only a medium shared in turns has turns to give twice");
  require(options.slots > 0, "the medium needs at least one back-off slot");
  require(options.rates.broadcast >= 0.0, "the bit rate of broadcasts is below zero");
  require(is_rising(options.rates.unicast), "the bit rates of unicasts, above zero, and their margins do not rise");
  require(options.rates.unicast_retries >= 0, "the retries of unicasts are below zero");
  require(options.rates.unicast_retries == 0 || options.contention, "retries of unicasts need a contended medium");
  require(options.rates.acknowledgment >= Time(0), "the air time of acknowledgments is below zero");
  require(options.wall_attenuation >= 0.0, "the attenuation of a wall is below zero");
  require(options.shadowing.deviation >= 0.0, "the standard deviation of the shadowing is below zero");
  require(options.shadowing.distance > 0.0, "the distance of the shadowing is not above zero");
  require(options.bursts.good >= Time(0) && options.bursts.bad >= Time(0), "the times of bursts are below zero");
  require(options.bursts.loss >= 0.0 && options.bursts.loss <= 1.0, "the loss of bursts is not between 0 and 1");
  require(options.delay.fixed >= Time(0) && options.delay.jitter >= Time(0), "the delay of frames is below zero");
  require(options.interference.duration >= Time(0), "the duration of the interference is below zero");
  require(options.interference.duration == Time(0) || options.interference.duration <= options.interference.period,
          "the interference lasts longer than its period");
  require(!options.path_loss || options.path_loss->n_model >= 0.0, "the path loss exponent is below zero");
  const Walls& walls = options.walls;
  if (walls.cells.empty()) return options;
  require(walls.width > 0 && walls.cells.size() % walls.width == 0, "the rows of the wall raster differ in length");
  require(walls.resolution > 0.0, "the resolution of the wall raster is not above zero");
  return options;
}

}  // namespace adhoc_communication
