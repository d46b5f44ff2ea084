#include "radio/listening_socket.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace adhoc_communication {
namespace {

FileDescriptor make_socket() {
  return FileDescriptor(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

}  // namespace

ListeningSocket::ListeningSocket(std::string path) : path_(std::move(path)), socket_(make_socket()) {
  struct sockaddr_un address {};
  address.sun_family = AF_UNIX;
  if (path_.size() >= sizeof address.sun_path) {
    throw std::runtime_error("socket path " + path_ + " is longer than " + std::to_string(sizeof address.sun_path - 1) +
                             " characters");
  }
  path_.copy(address.sun_path, path_.size());
  auto* generic = reinterpret_cast<struct sockaddr*>(&address);
  if (connect(make_socket().get(), generic, sizeof address) == 0) {
    throw std::runtime_error("something listens at socket " + path_ + " already");
  }
  if (errno == ECONNREFUSED) unlink(path_.c_str());  // left behind by a process that was killed
  if (bind(socket_.get(), generic, sizeof address) != 0 || listen(socket_.get(), SOMAXCONN) != 0) {
    throw std::runtime_error("cannot listen at socket " + path_ + ": " + std::strerror(errno));
  }
}

ListeningSocket::~ListeningSocket() { unlink(path_.c_str()); }

FileDescriptor ListeningSocket::accept() {
  return FileDescriptor(accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

}  // namespace adhoc_communication
