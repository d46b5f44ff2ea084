#include "link/capture_link.hpp"

namespace adhoc_communication {
namespace {

std::chrono::nanoseconds unix_now() { return std::chrono::system_clock::now().time_since_epoch(); }

}  // namespace

int CaptureLink::receive(const FrameTaker& take) {
  return link_->receive([&](const Frame& frame, Time arrived) {
    file_->add(frame, unix_now());
    take(frame, arrived);
  });
}

void CaptureLink::send(const Frame* first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) file_->add(first[i], unix_now());
  link_->send(first, count);
}

}  // namespace adhoc_communication
