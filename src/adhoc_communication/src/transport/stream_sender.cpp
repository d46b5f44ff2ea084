#include "transport/stream_sender.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication::transport {

void StreamSender::add(SendId id, Image image, std::uint16_t segment_size, Time now) {
  if (packets_.empty()) silence_.broken(now);
  packets_.push_back({id, next_number_++, std::move(image), now});
  cut(packets_.back(), sizes_.of_packet(segment_size, now));
}

/// Of what was sent in other segments before nothing counts.
void StreamSender::cut(OutgoingPacket& packet, std::uint16_t segment_size) {
  forget_sent(packet);
  unstarted_ -= packet.unstarted();
  packet.cut(segment_size);
  unstarted_ += packet.unstarted();
}

bool StreamSender::replace(SendId former, SendId id, const Image& image, std::uint16_t segment_size, Time now) {
  const auto packet = find_id(former);
  if (packet == packets_.end() || packet->begun) return false;
  packet->id = id;
  packet->image = image;
  packet->added = now;
  cut(*packet, sizes_.of_packet(segment_size, now));
  return true;
}

void StreamSender::drop(SendId id, Time now) {
  const auto packet = find_id(id);
  if (packet == packets_.end()) return;
  tell_given_up(*packet, now);
  forget_sent(*packet);
  unstarted_ -= packet->unstarted();
  packet->drop();
  pass_over_dropped();
}

void StreamSender::pass_over_dropped() {
  if (packets_.empty() || !packets_.front().dropped) return;
  while (!packets_.empty() && packets_.front().dropped) pop_front();
  tell_base();
}

/// What is now the first packet may have arrived and wait for those before: a segment of it carries the new base.
void StreamSender::tell_base() {
  if (packets_.empty() || packets_.front().started == 0) return;
  OutgoingPacket& first = packets_.front();
  probing_ = true;
  if (first.segments.front().lost) return;
  if (std::exchange(first.segments.front().acknowledged, false)) ++on_the_way_;
  first.first_open = 0;
  mark_lost(first, 0);
}

std::deque<OutgoingPacket>::iterator StreamSender::find_id(SendId id) {
  return std::find_if(packets_.begin(), packets_.end(),
                      [id](const OutgoingPacket& packet) { return packet.id == id && !packet.dropped; });
}

bool StreamSender::has_segment() const {
  if (!lost_.empty()) return true;
  if (on_the_way_ >= window_ || unstarted_ == 0 || paused_until_) return false;
  return unstarted()->may_start();
}

wire::Data StreamSender::next_segment(Time now) {
  if (!lost_.empty()) {
    const auto [number, index] = *lost_.begin();
    lost_.erase(lost_.begin());
    OutgoingPacket& packet = *find(number);
    packet.segments[index].lost = false;
    packet.segments[index].repeated = true;
    return segment(packet, index, now);
  }
  OutgoingPacket& packet = const_cast<OutgoingPacket&>(*unstarted());
  --unstarted_;
  return segment(packet, packet.started++, now);
}

/// Packets are begun in order. unstarted_ is not 0.
const OutgoingPacket* StreamSender::unstarted() const {
  const auto found = std::find_if(packets_.begin(), packets_.end(),
                                  [](const OutgoingPacket& packet) { return packet.unstarted() > 0; });
  return &*found;
}

wire::Data StreamSender::segment(OutgoingPacket& packet, std::uint32_t index, Time now) {
  packet.segments[index].leaves(now);
  packet.begun = true;
  ++on_the_way_;
  silence_.begins(now);
  wire::Data data = packet.data(stream_, index);
  data.base = packets_.front().number;
  data.acknowledge_now =
      probing_ || packet.refused_since || index + 1 == packet.segments.size() || on_the_way_ >= window_;
  probing_ = false;
  return data;
}

std::vector<SendId> StreamSender::acknowledged(const wire::TransportAcknowledgment& acknowledgment, Time now) {
  if (receiver_boot_ != 0 && receiver_boot_ != acknowledgment.source_boot) receiver_restarted();
  receiver_boot_ = acknowledgment.source_boot;
  progress_ = false;
  std::vector<SendId> finished;
  while (!packets_.empty() && static_cast<std::int32_t>(acknowledgment.next - packets_.front().number) > 0) {
    OutgoingPacket& packet = packets_.front();
    for (std::uint32_t index = packet.first_open; index < packet.segments.size(); ++index) take_one(packet, index, now);
    finished.push_back(packet.id);
    pop_front();
  }
  for (const wire::PartialPacket& partial : acknowledgment.partial) {
    OutgoingPacket* packet = find(partial.packet);
    if (packet != nullptr && packet->attempt == partial.attempt) take(*packet, partial, now);
  }
  for (const wire::RefusedPacket& refused : acknowledgment.refused) {
    OutgoingPacket* packet = find(refused.packet);
    if (packet != nullptr && packet->attempt == refused.attempt && packet->started > 0) begin_anew(*packet, now);
  }
  pass_over_dropped();
  if (progress_) {
    silence_.broken(now);
    mark_overtaken();
  }
  return finished;
}

/// The receiver lives and has no room: that is no silence, and nothing of what it has acknowledged counts. A segment
/// has arrived all the same and tells which of other packets are lost; none was sent sooner than the first.
void StreamSender::begin_anew(OutgoingPacket& packet, Time now) {
  if (const SentSegment& first = packet.segments.front(); first.on_the_way()) {
    arrivals_.acknowledged(first.sent, first.repeated, now);
  }
  progress_ = true;
  forget_sent(packet);
  unstarted_ += packet.started;
  packet.begin_anew();
  ++packet.attempt;
  if (!packet.refused_since) packet.refused_since = now;
  paused_until_ = now + kRoomRetry;
}

/// When frames of the first packet seem to be longer than something on the way takes.
Time StreamSender::shorter_at() const {
  if (packets_.empty() || packets_.front().started == 0 || packets_.front().arrives) return Time::max();
  return packets_.front().longest() > SegmentSize::kShortest ? silence_.suggests_shorter_at() : Time::max();
}

void StreamSender::try_shorter(Time now) {
  if (shorter_at() > now) return;
  const auto size = sizes_.shorter(static_cast<std::uint16_t>(packets_.front().longest()), now);
  if (!size) return;
  silence_.shortened(now);
  for (OutgoingPacket& packet : packets_) {
    if (packet.arrives || packet.longest() <= *size) continue;
    cut(packet, *size);
    ++packet.attempt;
  }
}

/// Takes its segments from those on the way and those lost.
void StreamSender::forget_sent(OutgoingPacket& packet) {
  for (std::uint32_t index = 0; index < packet.started; ++index) {
    if (packet.segments[index].on_the_way()) --on_the_way_;
  }
  lost_.erase(lost_.lower_bound({packet.number, 0}), lost_.upper_bound({packet.number, UINT32_MAX}));
}

void StreamSender::tell_given_up(const OutgoingPacket& packet, Time now) {
  if (!tells_ends_) return;
  for (std::uint32_t index = 0; index < packet.started; ++index) {
    const SentSegment& segment = packet.segments[index];
    if (segment.acknowledged || segment.sent < Time(0)) continue;
    ended_.push_back({packet.id, index, segment.repetitions, segment.first_sent, now, false});
  }
}

void StreamSender::pop_front() {
  unstarted_ -= packets_.front().unstarted();
  packets_.pop_front();
  if (unstarted_ == 0) paused_until_.reset();
}

void StreamSender::take(OutgoingPacket& packet, const wire::PartialPacket& partial, Time now) {
  packet.refused_since.reset();
  for (const std::uint32_t index : packet.newly_received(partial)) take_one(packet, index, now);
  packet.pass_over_acknowledged();
}

void StreamSender::take_one(OutgoingPacket& packet, std::uint32_t index, Time now) {
  SentSegment& segment = packet.segments[index];
  if (segment.acknowledged || segment.sent < Time(0)) return;
  segment.acknowledged = true;
  if (packet.is_longest(index)) {
    packet.arrives = true;
    sizes_.arrived(static_cast<std::uint16_t>(packet.longest()));
  }
  if (tells_ends_) ended_.push_back({packet.id, index, segment.repetitions, segment.first_sent, now, true});
  progress_ = true;
  if (segment.lost) {
    segment.lost = false;
    lost_.erase({packet.number, index});
  } else {
    --on_the_way_;
  }
  arrivals_.acknowledged(segment.sent, segment.repeated, now);
}

void StreamSender::mark_overtaken() {
  for (OutgoingPacket& packet : packets_) {
    for (std::uint32_t index = packet.first_open; index < packet.started; ++index) {
      const SentSegment& segment = packet.segments[index];
      if (segment.on_the_way() && arrivals_.overtaken(segment.sent)) mark_lost(packet, index);
    }
  }
}

void StreamSender::mark_lost(OutgoingPacket& packet, std::uint32_t index) {
  packet.segments[index].lost = true;
  lost_.insert({packet.number, index});
  --on_the_way_;
}

/// Another run of the receiver has nothing of what the former acknowledged.
void StreamSender::receiver_restarted() {
  for (OutgoingPacket& packet : packets_) {
    packet.begin_anew();
    packet.refused_since.reset();
  }
  unstarted_ = 0;
  for (const OutgoingPacket& packet : packets_) unstarted_ += packet.unstarted();
  paused_until_.reset();
  lost_.clear();
  on_the_way_ = 0;
  sizes_.reset();
  arrivals_.forget();
  silence_.start_over();
}

void StreamSender::route_changed(Time now) {
  silence_.begins(now);
  if (on_the_way_ > 0 || !lost_.empty()) silence_.asked_over_another_route();
  if (lost_.empty()) probe();
}

/// Repeats the oldest open segment and asks for an acknowledgment at once.
void StreamSender::probe() {
  for (OutgoingPacket& packet : packets_) {
    for (std::uint32_t index = packet.first_open; index < packet.started; ++index) {
      if (!packet.segments[index].on_the_way()) continue;
      mark_lost(packet, index);
      probing_ = true;
      return;
    }
  }
}

std::vector<StreamSender::GivenUp> StreamSender::expire(int most_resends, Time now, Random& random) {
  if (paused_until_ && *paused_until_ <= now) paused_until_.reset();
  std::vector<GivenUp> given_up = give_up_refused(now);
  try_shorter(now);
  const bool over = !packets_.empty() && silence_.hopeless_at(most_resends) <= now;
  if (!over && (on_the_way_ == 0 || silence_.ends(arrivals_.timeout()) > now)) return given_up;
  arrivals_.nothing_followed();
  mark_overtaken();
  if (!over && silence_.resends() < most_resends) {
    silence_.asked(arrivals_.timeout(), now, random);
    arrivals_.asked(now);
    probe();
    return given_up;
  }
  while (!packets_.empty() && (packets_.front().started > 0 || packets_.front().dropped)) {
    forget_sent(packets_.front());
    tell_given_up(packets_.front(), now);
    if (!packets_.front().dropped) given_up.push_back({packets_.front().id, now - packets_.front().added, false});
    pop_front();
  }
  silence_.broken(now);
  return given_up;
}

std::vector<StreamSender::GivenUp> StreamSender::give_up_refused(Time now) {
  std::vector<GivenUp> given_up;
  while (!packets_.empty() && packets_.front().refused_since) {
    const OutgoingPacket& packet = packets_.front();
    if (now - *packet.refused_since < kRoomPatience) break;
    forget_sent(packets_.front());
    tell_given_up(packet, now);
    given_up.push_back({packet.id, now - packet.added, true});
    pop_front();
  }
  pass_over_dropped();
  if (!given_up.empty()) tell_base();
  return given_up;
}

std::vector<SendId> StreamSender::abandon(Time now) {
  std::vector<SendId> ids;
  for (const OutgoingPacket& packet : packets_) tell_given_up(packet, now);
  for (const OutgoingPacket& packet : packets_) ids.push_back(packet.id);
  packets_.clear();
  lost_.clear();
  on_the_way_ = 0;
  unstarted_ = 0;
  paused_until_.reset();
  silence_.start_over();
  return ids;
}

Time StreamSender::next_deadline() const {
  const Time silence = on_the_way_ == 0 ? Time::max() : silence_.ends(arrivals_.timeout());
  return std::min(silence, paused_until_.value_or(Time::max()));
}

Time StreamSender::look_again_at(int most_resends) const {
  if (packets_.empty()) return Time::max();
  const auto& refused = packets_.front().refused_since;
  const Time no_room = refused ? *refused + kRoomPatience : Time::max();
  return std::min({next_deadline(), silence_.hopeless_at(most_resends), shorter_at(), no_room});
}

OutgoingPacket* StreamSender::find(std::uint32_t number) {
  if (packets_.empty()) return nullptr;
  const std::uint32_t offset = number - packets_.front().number;
  return offset < packets_.size() ? &packets_[offset] : nullptr;
}

}  // namespace adhoc_communication::transport
