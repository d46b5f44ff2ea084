// What hosts may write down: counters and records.
#include "engine_implementation.hpp"

namespace adhoc_communication {
std::vector<Record> Engine::Implementation::take_records() {
  statistics_.records_lost = journal_.lost();
  return journal_.take();
}

}  // namespace adhoc_communication
