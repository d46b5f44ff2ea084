#include "transport/streams.hpp"

#include <algorithm>

#include "texts.hpp"
#include "transport/turn_taking.hpp"

namespace adhoc_communication::transport {
namespace {

/// What is known of a route is kept as long as data is due for it: this often it is said that it still is.
constexpr Time kStillSearching = std::chrono::milliseconds(500);

}  // namespace

Streams::Streams(const Identity& self, const EngineOptions& options, const routing::RobotDirectory& directory,
                 routing::Router& router, Hops& hops, Random& random, Journal& journal, std::size_t segment_size)
    : self_(self),
      options_(options),
      directory_(directory),
      router_(router),
      hops_(hops),
      random_(random),
      journal_(journal),
      segment_size_(static_cast<std::uint16_t>(segment_size)) {}

Streams::Stream* Streams::find(const std::string& destination, std::uint8_t priority) {
  const auto found = streams_.find({destination, priority});
  return found == streams_.end() ? nullptr : &found->second;
}

void Streams::add(SendId id, const std::string& destination, Image image, Priority priority, Time now) {
  news_ = true;
  if (streams_.size() >= kMostStreams) forget_idle();
  const Key key{destination, static_cast<std::uint8_t>(priority)};
  Stream* stream = find(destination, key.second);
  if (stream == nullptr) {
    const std::size_t window = options_.num_link_retrans == 0 ? 4 : StreamSender::kWindow;
    // Send ids only grow, so a stream that was dropped while idle never uses a packet number twice.
    const auto first_number = static_cast<std::uint32_t>(id);
    StreamSender sender(key.second, first_number, window, journal_.kept());
    stream = &streams_.emplace(key, Stream{key, std::move(sender)}).first->second;
  }
  stream->sender.add(id, std::move(image), segment_size_, now);
  changed(*stream);
}

void Streams::forget_idle() {
  for (auto entry = streams_.begin(); entry != streams_.end();) {
    entry = busy_.count(entry->first) == 0 ? streams_.erase(entry) : std::next(entry);
  }
}

bool Streams::replace(const std::string& destination, Priority priority, SendId former, SendId id, const Image& image,
                      Time now) {
  Stream* stream = find(destination, static_cast<std::uint8_t>(priority));
  if (stream == nullptr || !stream->sender.replace(former, id, image, segment_size_, now)) return false;
  changed(*stream);
  return true;
}

void Streams::drop(const std::string& destination, Priority priority, SendId id, Time now) {
  Stream* stream = find(destination, static_cast<std::uint8_t>(priority));
  if (stream == nullptr) return;
  stream->sender.drop(id, now);
  changed(*stream);
}

std::vector<SendId> Streams::acknowledged(const wire::TransportAcknowledgment& acknowledgment, Time now) {
  const routing::Robot* robot = directory_.find(acknowledgment.source);
  Stream* stream = robot == nullptr ? nullptr : find(robot->name, acknowledgment.stream);
  if (stream == nullptr || stream->address != acknowledgment.source) return {};
  std::vector<SendId> arrived = stream->sender.acknowledged(acknowledgment, now);
  changed(*stream);
  return arrived;
}

// --- what is due -----------------------------------------------------------------------------------------------------

void Streams::changed(Stream& stream) {
  busy_.emplace(stream.key, &stream);
  changed_.insert(stream.key);
  sort_in(stream);
}

void Streams::sort_in(Stream& stream) {
  ready_.set(stream.key, &stream, stream.sender.has_segment() ? stream.next_hop : std::nullopt);
  timers_.set(&stream, stream.next_hop ? stream.sender.next_deadline() : Time::max());
}

void Streams::note(const std::string& destination) {
  for (std::uint8_t priority = 0; priority < kPriorities; ++priority) {
    const Key key{destination, priority};
    if (busy_.count(key) != 0) changed_.insert(key);
  }
}

void Streams::repair_failed(const MacAddress& destination) {
  if (const routing::Robot* robot = directory_.find(destination)) note(robot->name);
}

/// Streams to which routes or addresses may have changed.
void Streams::note_changes() {
  for (const MacAddress& destination : router_.take_changed_routes()) {
    if (const routing::Robot* robot = directory_.find(destination)) note(robot->name);
  }
  if (std::exchange(directory_version_, directory_.version()) == directory_.version()) return;
  for (const auto& [key, stream] : busy_) changed_.insert(key);
}

std::vector<Undelivered> Streams::serve(Time now) {
  note_changes();
  for (Stream* stream : look_again_.due(now)) changed_.insert(stream->key);
  std::vector<Undelivered> undelivered;
  for (const Key& key : std::exchange(changed_, {})) {
    Stream& stream = *busy_.at(key);
    Time again = Time::max();
    if (!stream.sender.idle()) again = serve(stream, undelivered, now);
    record(stream, now);
    if (stream.sender.idle()) {
      again = Time::max();
      stream.next_hop.reset();
      busy_.erase(key);
    }
    sort_in(stream);
    look_again_.set(&stream, again);
  }
  return undelivered;
}

/// Returns when a look is worth its time again.
Time Streams::serve(Stream& stream, std::vector<Undelivered>& undelivered, Time now) {
  const std::string& destination = stream.key.first;
  stream.address = directory_.address_of(destination);
  const routing::Route* route = stream.address ? router_.route_to(*stream.address, now) : nullptr;
  if (route == nullptr) {
    stream.next_hop.reset();
    stream.sender.route_missing(now);
    router_.search({stream.address.value_or(MacAddress{}), destination}, now);
    return now + kStillSearching;
  }
  stream.beyond = routing::hops_beyond(*route);
  if (stream.next_hop != route->next_hop) {
    stream.next_hop = route->next_hop;
    stream.sender.route_changed(now);
  }
  if (const HopSender* first = hops_.sender_to(route->next_hop)) {
    stream.sender.expect((stream.beyond + 1) * first->least_round_trip());
  }
  for (const auto& [id, elapsed, no_room] : stream.sender.expire(options_.num_e2e_retrans, now, random_)) {
    const char* reason = no_room ? " had no room for it for " : " did not acknowledge within ";
    undelivered.push_back({id, destination + reason + seconds_text(elapsed)});
  }
  return std::min(stream.sender.look_again_at(options_.num_e2e_retrans), route->expires);
}

std::vector<SendId> Streams::abandon(const std::string& destination, Time now) {
  std::vector<SendId> abandoned;
  for (std::uint8_t priority = 0; priority < kPriorities; ++priority) {
    Stream* stream = find(destination, priority);
    if (stream == nullptr) continue;
    const std::vector<SendId> ids = stream->sender.abandon(now);
    abandoned.insert(abandoned.end(), ids.begin(), ids.end());
    record(*stream, now);
    changed(*stream);
  }
  return abandoned;
}

void Streams::record(Stream& stream, Time now) {
  const std::vector<StreamSender::Ended> all = stream.sender.take_ended();
  if (all.empty()) return;
  const RouteEnds route = router_.ends_to(stream.address.value_or(MacAddress{}), now);
  for (const auto& [packet, index, repetitions, sent, ended, delivered] : all) {
    journal_.add(now, SegmentEnded{packet, index, stream.key.first, repetitions, sent, ended, delivered, route});
  }
}

// --- what goes on the air --------------------------------------------------------------------------------------------

bool Streams::send_segment(std::uint8_t priority, Time now) {
  Stream* stream = ready_.next(priority, last_served_,
                               [&](const MacAddress& neighbor) { return hops_.may_start(neighbor, priority, now); });
  if (stream != nullptr) send_segment(*stream, now);
  return stream != nullptr;
}

void Streams::send_segment(Stream& stream, Time now) {
  last_served_ = stream.key;
  const bool again = stream.sender.repeats();
  wire::Data data = stream.sender.next_segment(now);
  data.source = self_.address;
  data.source_boot = self_.boot;
  data.destination = *stream.address;
  router_.used(self_.address, data.destination, self_.address, now);
  HopFrame frame{wire::FrameType::kData, to_bytes(data), stream.key.second, {}, again};
  frame.beyond = stream.beyond;
  frame.route = TurnTaking::fills_turns(data) ? stream.beyond + 1 : 0;
  frame.more = stream.sender.has_segment();
  hops_.start(*stream.next_hop, std::move(frame), now);
  changed(stream);
}

bool Streams::something_to_send(Time now) const {
  return ready_.any_over(
      [&](const MacAddress& neighbor, std::uint8_t priority) { return hops_.has_room(neighbor, priority, now); });
}

}  // namespace adhoc_communication::transport
