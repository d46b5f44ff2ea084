// The radio daemon: a Medium in real time between the network interfaces or hub sockets of robots.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "medium/medium.hpp"
#include "radio/listening_socket.hpp"
#include "radio/options.hpp"
#include "radio/port.hpp"

namespace adhoc_communication {

class Radio {
 public:
  /// Throws LinkError or std::runtime_error with one sentence.
  explicit Radio(const RadioOptions& options);

  /// Returns when `signals` (a signalfd) becomes readable.
  void run(int signals);

  std::string statistics() const;  ///< JSON

 private:
  void watch(int descriptor);
  void serve(int descriptor, Time now);
  void accept_hub_client();
  void name_hub_client(int descriptor, Time now);
  void accept_control_client();
  void serve_control_client(int descriptor, Time now);
  void carry_frames(Medium::Node node, Time now);
  void deliver(Time now);
  void arm_timer();

  Medium medium_;
  FileDescriptor epoll_;
  FileDescriptor timer_;
  std::map<Medium::Node, std::unique_ptr<Port>> ports_;
  std::map<int, Medium::Node> node_of_descriptor_;
  std::unique_ptr<ListeningSocket> hub_;
  std::unique_ptr<ListeningSocket> control_;
  std::map<int, std::unique_ptr<HubPort>> unnamed_clients_;
  std::map<int, FileDescriptor> control_clients_;
};

}  // namespace adhoc_communication
