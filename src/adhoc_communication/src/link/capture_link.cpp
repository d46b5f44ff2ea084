#include "link/capture_link.hpp"

namespace adhoc_communication {
namespace {

std::chrono::nanoseconds unix_now() { return std::chrono::system_clock::now().time_since_epoch(); }

}  // namespace

std::optional<Frame> CaptureLink::receive() {
  auto frame = link_->receive();
  if (frame) file_->add(*frame, unix_now());
  return frame;
}

void CaptureLink::send(const Frame& frame) {
  file_->add(frame, unix_now());
  link_->send(frame);
}

}  // namespace adhoc_communication
