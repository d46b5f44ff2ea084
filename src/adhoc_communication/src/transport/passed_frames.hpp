// Frames that neighbours have, as the log tells of them.
#pragma once

#include <vector>

#include "api/journal.hpp"
#include "identity.hpp"
#include "routing/robot_directory.hpp"
#include "transport/hop_sender.hpp"

namespace adhoc_communication::transport {

class PassedFrames {
 public:
  PassedFrames(const Identity& self, const routing::RobotDirectory& directory, Journal& journal)
      : self_(self), directory_(directory), journal_(journal) {}

  /// Whether anybody wants to know.
  bool wanted() const { return journal_.kept(); }
  void add(const MacAddress& neighbor, const std::vector<HopSender::Passed>& passed, Time now);

 private:
  const Identity& self_;
  const routing::RobotDirectory& directory_;
  Journal& journal_;
};

}  // namespace adhoc_communication::transport
