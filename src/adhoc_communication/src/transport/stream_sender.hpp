// Packets of one priority to one robot: cut into segments, repeated until the robot has them, finished in order.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "random.hpp"
#include "routing/sequence_number.hpp"
#include "transport/arrivals.hpp"
#include "transport/outgoing_packet.hpp"
#include "transport/segment_size.hpp"
#include "transport/silence.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

class StreamSender {
 public:
  static constexpr std::size_t kWindow = 768;  ///< segments on their way at once; an acknowledgment covers as many
  /// Until a packet that the receiver had no room for is offered again, and until it is given up.
  static constexpr Time kRoomRetry = std::chrono::milliseconds(100);
  static constexpr Time kRoomPatience = std::chrono::seconds(60);

  struct GivenUp {
    SendId id;
    Time elapsed;
    bool no_room;  ///< at the receiver; otherwise it did not answer
  };

  /// A segment that has arrived, or that is given up.
  struct Ended {
    SendId packet;
    std::uint32_t index;
    int repetitions;
    Time sent;  ///< for the first time
    Time ended;
    bool delivered;
  };

  /// `first_number` has to be beyond every packet number sent to this robot before. `tells_ends`: somebody takes them.
  StreamSender(std::uint8_t stream, std::uint32_t first_number, std::size_t window, bool tells_ends = false)
      : stream_(stream), window_(window), tells_ends_(tells_ends), next_number_(first_number) {}

  void add(SendId id, Image image, std::uint16_t segment_size, Time now);
  /// Puts another packet in the place of one of which nothing was ever sent. False if there is no such packet.
  bool replace(SendId former, SendId id, const Image& image, std::uint16_t segment_size, Time now);
  /// The receiver is to pass the packet over, however much of it has arrived.
  void drop(SendId id, Time now);
  bool idle() const { return packets_.empty(); }
  bool has_segment() const;
  /// The next segment was sent before.
  bool repeats() const { return !lost_.empty(); }
  /// The next segment; source and destination are left to the caller. has_segment() holds.
  wire::Data next_segment(Time now);

  /// Returns the packets that the receiver has delivered.
  std::vector<SendId> acknowledged(const wire::TransportAcknowledgment& acknowledgment, Time now);

  /// Frames may have been lost on the old route: ask the receiver at once what it has.
  void route_changed(Time now);
  /// While there is no route nothing is expected and no timer runs.
  void route_missing(Time now) { silence_.begins(now); }
  /// The way there and back takes so long at least.
  void expect(Time way) { arrivals_.expect(way); }

  /// Sends the probe that is due. Returns the packets given up: after `most_resends` of them without progress, or for
  /// want of room.
  std::vector<GivenUp> expire(int most_resends, Time now, Random& random);
  /// Gives up everything, for a reason the caller knows.
  std::vector<SendId> abandon(Time now);
  bool has_ended() const { return !ended_.empty(); }
  std::vector<Ended> take_ended() { return std::exchange(ended_, {}); }
  Time next_deadline() const;
  /// Before then expire() does nothing. Not later than next_deadline(): some of it may wait for another occasion.
  Time look_again_at(int most_resends) const;

 private:
  using Place = std::pair<std::uint32_t, std::uint32_t>;  ///< packet number, segment index
  struct PlaceOrder {
    bool operator()(const Place& a, const Place& b) const {
      return a.first == b.first ? a.second < b.second : routing::is_newer(b.first, a.first);
    }
  };

  OutgoingPacket* find(std::uint32_t number);
  void begin_anew(OutgoingPacket& packet, Time now);
  void cut(OutgoingPacket& packet, std::uint16_t segment_size);
  Time shorter_at() const;
  void try_shorter(Time now);
  void forget_sent(OutgoingPacket& packet);
  void tell_given_up(const OutgoingPacket& packet, Time now);
  void pop_front();
  void pass_over_dropped();
  void tell_base();
  std::deque<OutgoingPacket>::iterator find_id(SendId id);
  std::vector<GivenUp> give_up_refused(Time now);
  wire::Data segment(OutgoingPacket& packet, std::uint32_t index, Time now);
  void take(OutgoingPacket& packet, const wire::PartialPacket& partial, Time now);
  void take_one(OutgoingPacket& packet, std::uint32_t index, Time now);
  void mark_overtaken();
  void mark_lost(OutgoingPacket& packet, std::uint32_t index);
  void receiver_restarted();
  void probe();
  const OutgoingPacket* unstarted() const;

  std::uint8_t stream_;
  std::size_t window_;
  bool tells_ends_;
  std::uint32_t next_number_;
  std::deque<OutgoingPacket> packets_;
  std::set<Place, PlaceOrder> lost_;
  std::vector<Ended> ended_;
  std::size_t on_the_way_ = 0;  ///< segments sent, neither acknowledged nor lost
  std::size_t unstarted_ = 0;   ///< segments never sent
  SegmentSize sizes_;
  std::optional<Time> paused_until_;  ///< a packet waits for room, and those behind it with it
  wire::BootTag receiver_boot_ = 0;
  Arrivals arrivals_;
  Silence silence_;
  bool progress_ = false;
  bool probing_ = false;
};

}  // namespace adhoc_communication::transport
