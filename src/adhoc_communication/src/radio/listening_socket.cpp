#include "radio/listening_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace adhoc_communication {
namespace {

FileDescriptor make_socket() {
  return FileDescriptor(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

class Address {
 public:
  explicit Address(const std::string& path) {
    if (path.size() >= sizeof address_.sun_path) {
      throw std::runtime_error("socket path " + path + " is longer than " +
                               std::to_string(sizeof address_.sun_path - 1) + " characters");
    }
    address_.sun_family = AF_UNIX;
    path.copy(address_.sun_path, path.size());
  }
  const struct sockaddr* get() const { return reinterpret_cast<const struct sockaddr*>(&address_); }
  static constexpr socklen_t kSize = sizeof(struct sockaddr_un);

 private:
  struct sockaddr_un address_ {};
};

void check_replaceable(const std::string& path) {
  struct stat there {};
  if (lstat(path.c_str(), &there) != 0) return;
  if (!S_ISSOCK(there.st_mode)) throw std::runtime_error("there is something at " + path + " that is no socket");
  // Nobody listens at what a process left behind that was killed.
  if (connect(make_socket().get(), Address(path).get(), Address::kSize) == 0) {
    throw std::runtime_error("something listens at socket " + path + " already");
  }
}

}  // namespace

ListeningSocket::ListeningSocket(std::string path) : path_(std::move(path)), socket_(make_socket()) {
  const std::string unready = path_ + "~";
  const Address address(unready);
  check_replaceable(path_);
  check_replaceable(unready);
  unlink(unready.c_str());
  // It gets its name when it listens: who sees that can connect.
  if (bind(socket_.get(), address.get(), Address::kSize) != 0 || listen(socket_.get(), SOMAXCONN) != 0 ||
      rename(unready.c_str(), path_.c_str()) != 0) {
    throw std::runtime_error("cannot listen at socket " + path_ + ": " + std::strerror(errno));
  }
}

ListeningSocket::~ListeningSocket() { unlink(path_.c_str()); }

FileDescriptor ListeningSocket::accept() {
  return FileDescriptor(accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

}  // namespace adhoc_communication
