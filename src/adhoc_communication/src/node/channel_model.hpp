// Log-distance path loss of simulation_mode: which frames reach this robot.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "adhoc_communication/types.hpp"
#include "propagation/position.hpp"

namespace adhoc_communication {

/// Parameters of the contract, which are whole numbers; the defaults are those of PathLoss.
struct ChannelModel {
  int p_thres = -75;   ///< weakest power received, dBm
  int p_tx = 15;       ///< transmit power, dBm
  int n_model = 4;     ///< path loss exponent
  int l_0_model = 33;  ///< path loss at 1 m, dB
};

bool is_received(const ChannelModel& model, double distance);

/// Ground truth of the robots, written by subscribers and read by the thread of the engine.
class PositionTable {
 public:
  void set(const std::string& robot, Position position);
  std::optional<Position> get(const std::string& robot) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Position> positions_;
};

/// Decides on each frame heard whether it would have been received. One thread.
class ReceiveFilter {
 public:
  /// `names` is the whitelist of sim_robot_macs, empty for none. Without `positions` there is no channel model.
  ReceiveFilter(std::string own_name, std::map<MacAddress, std::string> names, ChannelModel model,
                const PositionTable* positions);

  bool accepts(const Frame& frame);

  /// The address of a sender whose name is not known and has not been reported yet.
  std::optional<MacAddress> next_unnamed_sender();

 private:
  std::optional<std::string> name_of(const MacAddress& address) const;

  std::string own_name_;
  std::map<MacAddress, std::string> names_;
  ChannelModel model_;
  const PositionTable* positions_;
  std::set<MacAddress> unnamed_senders_;
  std::optional<MacAddress> unreported_sender_;
};

}  // namespace adhoc_communication
