// What a scenario ends with when the engine breaks a promise.
#pragma once

#include <stdexcept>

namespace adhoc_communication {

class Violation : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace adhoc_communication
