#include "node/commands.hpp"

#include <sys/eventfd.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "run_guarded.hpp"

namespace adhoc_communication {

Commands::Commands() : news_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

bool Commands::post(Command command) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (closed_) return false;
  posted_.push_back(std::move(command));
  eventfd_write(news_.get(), 1);
  return true;
}

void Commands::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
  eventfd_write(news_.get(), 1);
}

bool Commands::closed() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return closed_;
}

void Commands::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (posted_.empty()) return;
  eventfd_t count = 0;
  eventfd_read(news_.get(), &count);
  std::move(posted_.begin(), posted_.end(), std::back_inserter(taken_));
  posted_.clear();
}

void Commands::run(Time now) {
  take();
  for (; !taken_.empty(); taken_.pop_front()) taken_.front().run(now);
}

void Commands::fail() {
  take();
  for (; !taken_.empty(); taken_.pop_front()) run_guarded("", taken_.front().fail, [](const std::string&) {});
}

}  // namespace adhoc_communication
