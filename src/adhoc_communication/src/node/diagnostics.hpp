// /diagnostics: how the radio is, in the form that monitors of whole robots read.
#pragma once

#include <adhoc_communication/NetworkState.h>
#include <diagnostic_msgs/DiagnosticArray.h>

#include <cstdint>
#include <map>
#include <string>

namespace adhoc_communication {

/// A counter of losses warns while it grows, and for some reports after, so that a monitor at 1 Hz sees it.
class Diagnostics {
 public:
  static constexpr int kReportsAfterLoss = 10;

  diagnostic_msgs::DiagnosticArray report(const NetworkState& state);

 private:
  struct Watched {
    std::uint64_t value = 0;
    int reports_left = 0;
    std::uint64_t report = 0;  ///< in which it was looked at last
  };

  /// Whether a counter grows, or has grown lately.
  bool grows(const std::string& name, std::uint64_t value);
  void forget_unwatched();

  diagnostic_msgs::DiagnosticStatus interface(const NetworkState& state);
  diagnostic_msgs::DiagnosticStatus security(const NetworkState& state);
  diagnostic_msgs::DiagnosticStatus neighbors(const NetworkState& state);
  diagnostic_msgs::DiagnosticStatus queues(const NetworkState& state);
  diagnostic_msgs::DiagnosticStatus dropped_frames(const NetworkState& state);
  diagnostic_msgs::DiagnosticStatus publishing(const NetworkState& state);
  diagnostic_msgs::DiagnosticStatus relays(const NetworkState& state);
  diagnostic_msgs::DiagnosticStatus files(const NetworkState& state);

  std::map<std::string, Watched> watched_;
  std::uint64_t report_ = 0;
};

}  // namespace adhoc_communication
