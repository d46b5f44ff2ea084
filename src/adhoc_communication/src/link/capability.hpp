// Rights of the process that are lowered until they are needed.
#pragma once

namespace adhoc_communication {

/// At the start of a program: capabilities that its file grants are kept in reserve.
void lower_capabilities();

/// Has cap_net_raw (and cap_net_admin) while it lives, as far as the process may. Of this thread only.
class RaisedCapabilities {
 public:
  RaisedCapabilities();
  ~RaisedCapabilities();
  RaisedCapabilities(const RaisedCapabilities&) = delete;
  RaisedCapabilities& operator=(const RaisedCapabilities&) = delete;
};

}  // namespace adhoc_communication
