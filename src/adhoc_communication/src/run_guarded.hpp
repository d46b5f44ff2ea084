// The outermost call of a thread.
#pragma once

#include <exception>
#include <string>

namespace adhoc_communication {

/// Runs `work`; should it end by an exception of whatever kind, `tell` is given one sentence that says what has ended
/// and why, instead of the whole process.
template <typename Work, typename Tell>
void run_guarded(const std::string& name, Work work, Tell tell) {
  try {
    work();
  } catch (const std::exception& error) {
    tell(name + " has ended: " + error.what());
  } catch (...) {
    tell(name + " has ended by an unknown exception");
  }
}

}  // namespace adhoc_communication
