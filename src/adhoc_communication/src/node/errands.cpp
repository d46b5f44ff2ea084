#include "node/errands.hpp"

#include <utility>

#include "node/end_node.hpp"
#include "run_guarded.hpp"

namespace adhoc_communication {

Errands::~Errands() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  added_.notify_all();
  thread_.join();
}

void Errands::add(Errand errand) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (waiting_.size() >= most_) waiting_.pop_front();
  waiting_.push_back(std::move(errand));
  added_.notify_one();
}

void Errands::run() {
  run_guarded(
      "running errands", [this] { work(); }, end_node);
}

void Errands::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    added_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    if (stopping_) return;
    const Errand errand = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    errand();
    lock.lock();
  }
}

}  // namespace adhoc_communication
