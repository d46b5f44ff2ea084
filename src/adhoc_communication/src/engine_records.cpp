// What hosts may write down: counters and records.
#include "engine_implementation.hpp"

namespace adhoc_communication {
std::vector<Record> Engine::Implementation::take_records() {
  statistics_.records_lost = journal_.lost();
  return journal_.take();
}

void Engine::Implementation::record_segments(const StreamKey& key, Stream& stream, Time now) {
  const std::vector<transport::StreamSender::Ended> all = stream.sender.take_ended();
  if (all.empty()) return;
  const RouteEnds route = router_.ends_to(stream.address.value_or(MacAddress{}), now);
  for (const auto& [packet, index, repetitions, sent, ended, delivered] : all) {
    journal_.add(now, SegmentEnded{packet, index, key.first, repetitions, sent, ended, delivered, route});
  }
}

}  // namespace adhoc_communication
