#include "transport/streams.hpp"

#include <algorithm>

#include "round_robin.hpp"
#include "texts.hpp"

namespace adhoc_communication::transport {

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

Streams::Stream* Streams::find(const std::string& destination, Priority priority) {
  return streams_.find({destination, static_cast<std::uint8_t>(priority)});
}

void Streams::add(SendId id, const std::string& destination, Image image, Priority priority, Time now) {
  news_ = true;
  if (streams_.size() >= kMostStreams) {
    streams_.erase_if([this](const Key& key, const Stream&) { return !streams_.is_busy(key); });
  }
  const Key key{destination, static_cast<std::uint8_t>(priority)};
  const std::size_t window = options_.num_link_retrans == 0 ? 4 : StreamSender::kWindow;
  // Send ids only grow, so a stream that was dropped while idle never uses a packet number twice.
  const auto first_number = static_cast<std::uint32_t>(id);
  Stream& stream = streams_.use(key, [&] {
    return Stream{StreamSender(key.second, first_number, window, journal_.kept()), {}, {}};
  });
  stream.sender.add(id, std::move(image), segment_size_, now);
}

bool Streams::replace(const std::string& destination, Priority priority, SendId former, SendId id, const Image& image,
                      Time now) {
  Stream* stream = find(destination, priority);
  return stream != nullptr && stream->sender.replace(former, id, image, segment_size_, now);
}

void Streams::drop(const std::string& destination, Priority priority, SendId id, Time now) {
  if (Stream* stream = find(destination, priority)) stream->sender.drop(id, now);
}

std::vector<SendId> Streams::acknowledged(const wire::TransportAcknowledgment& acknowledgment, Time now) {
  const routing::Robot* robot = directory_.find(acknowledgment.source);
  if (robot == nullptr) return {};
  Stream* stream = streams_.find({robot->name, acknowledgment.stream});
  if (stream == nullptr || stream->address != acknowledgment.source) return {};
  return stream->sender.acknowledged(acknowledgment, now);
}

std::vector<Undelivered> Streams::serve(Time now) {
  std::vector<Undelivered> undelivered;
  for (const auto& [key, stream] : streams_.busy()) {
    if (!stream->sender.idle()) serve(key, *stream, undelivered, now);
    record(key, *stream, now);
  }
  streams_.settle([](Stream& stream) {
    if (stream.sender.idle()) stream.next_hop.reset();
    return stream.sender.idle();
  });
  return undelivered;
}

void Streams::serve(const Key& key, Stream& stream, std::vector<Undelivered>& undelivered, Time now) {
  stream.address = directory_.address_of(key.first);
  const routing::Route* route = stream.address ? router_.route_to(*stream.address, now) : nullptr;
  if (route == nullptr) {
    stream.next_hop.reset();
    stream.sender.route_missing(now);
    return router_.search({stream.address.value_or(MacAddress{}), key.first}, now);
  }
  if (stream.next_hop != route->next_hop) {
    stream.next_hop = route->next_hop;
    stream.sender.route_changed(now);
  }
  for (const auto& [id, elapsed, no_room] : stream.sender.expire(options_.num_e2e_retrans, now, random_)) {
    const char* reason = no_room ? " had no room for it for " : " did not acknowledge within ";
    undelivered.push_back({id, key.first + reason + seconds_text(elapsed)});
  }
}

std::vector<SendId> Streams::abandon(const std::string& destination, Time now) {
  std::vector<SendId> abandoned;
  for (std::uint8_t priority = 0; priority < kPriorities; ++priority) {
    const Key key{destination, priority};
    Stream* stream = streams_.find(key);
    if (stream == nullptr) continue;
    const std::vector<SendId> ids = stream->sender.abandon(now);
    abandoned.insert(abandoned.end(), ids.begin(), ids.end());
    record(key, *stream, now);
  }
  return abandoned;
}

void Streams::record(const Key& key, Stream& stream, Time now) {
  const std::vector<StreamSender::Ended> all = stream.sender.take_ended();
  if (all.empty()) return;
  const RouteEnds route = router_.ends_to(stream.address.value_or(MacAddress{}), now);
  for (const auto& [packet, index, repetitions, sent, ended, delivered] : all) {
    journal_.add(now, SegmentEnded{packet, index, key.first, repetitions, sent, ended, delivered, route});
  }
}

Time Streams::next_deadline() const {
  Time next = Time::max();
  for (const auto& [key, stream] : streams_.busy()) {
    if (stream->next_hop) next = std::min(next, stream->sender.next_deadline());
  }
  return next;
}

bool Streams::send_segment(std::uint8_t priority, Time now) {
  return visit_after(streams_.busy(), last_served_, [&](const auto& item) {
    return item.first.second == priority && send_segment(item.first, *item.second, now);
  });
}

bool Streams::send_segment(const Key& key, Stream& stream, Time now) {
  if (!stream.next_hop || !stream.sender.has_segment() || !hops_.may_start(*stream.next_hop, now)) return false;
  last_served_ = key;
  const bool again = stream.sender.repeats();
  wire::Data data = stream.sender.next_segment(now);
  data.source = self_.address;
  data.source_boot = self_.boot;
  data.destination = *stream.address;
  router_.used(self_.address, data.destination, self_.address, now);
  hops_.start(*stream.next_hop, {wire::FrameType::kData, to_bytes(data), key.second, {}, again}, now);
  return true;
}

bool Streams::something_to_send() const {
  return std::any_of(streams_.busy().begin(), streams_.busy().end(), [this](const auto& item) {
    const Stream& stream = *item.second;
    return stream.next_hop && stream.sender.has_segment() && hops_.has_room(*stream.next_hop);
  });
}

}  // namespace adhoc_communication::transport
