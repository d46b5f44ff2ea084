// A Unix SOCK_SEQPACKET socket that others connect to; its file goes with its owner.
#pragma once

#include <string>

#include "link/file_descriptor.hpp"

namespace adhoc_communication {

class ListeningSocket {
 public:
  /// Throws std::runtime_error when something is listening there already or the path cannot be used.
  explicit ListeningSocket(std::string path);
  ~ListeningSocket();
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;

  int descriptor() const { return socket_.get(); }
  FileDescriptor accept();

 private:
  std::string path_;
  FileDescriptor socket_;
};

}  // namespace adhoc_communication
