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
#include "transport/packet_image.hpp"
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
  struct Segment {
    Time sent{-1};
    Time first_sent{-1};
    int repetitions = 0;
    bool acknowledged = false;
    bool lost = false;  ///< waits in lost_
    bool repeated = false;
  };
  struct Outgoing {
    SendId id;
    std::uint32_t number;
    Image image;
    std::uint16_t segment_size;
    Time added;
    std::vector<Segment> segments;
    std::uint32_t started = 0;     ///< segments sent at least once
    std::uint32_t first_open = 0;  ///< every segment before is acknowledged
    std::uint8_t attempt = 0;
    std::optional<Time> refused_since{};  ///< the receiver has no room; one segment at a time asks for it
    bool begun = false;                   ///< some of it was sent, in whatever attempt
    bool dropped = false;                 ///< keeps its number until those before are finished
    bool arrives = false;                 ///< one of its longest segments has

    std::size_t longest() const { return dropped ? 0 : std::min<std::size_t>(image->size(), segment_size); }
    bool is_longest(std::uint32_t index) const { return index == 0 || index + 1 < segments.size(); }

    bool may_start() const { return started < segments.size() && (!refused_since || started == 0); }
  };
  using Place = std::pair<std::uint32_t, std::uint32_t>;  ///< packet number, segment index
  struct PlaceOrder {
    bool operator()(const Place& a, const Place& b) const {
      return a.first == b.first ? a.second < b.second : routing::is_newer(b.first, a.first);
    }
  };

  Outgoing* find(std::uint32_t number);
  void begin_anew(Outgoing& packet, Time now);
  void cut(Outgoing& packet, std::uint16_t segment_size);
  Time shorter_at() const;
  void try_shorter(Time now);
  void forget_sent(Outgoing& packet);
  void tell_given_up(const Outgoing& packet, Time now);
  void pop_front();
  void pass_over_dropped();
  std::deque<Outgoing>::iterator find_id(SendId id);
  std::vector<GivenUp> give_up_refused(Time now);
  wire::Data segment(Outgoing& packet, std::uint32_t index, Time now);
  void take(Outgoing& packet, const wire::PartialPacket& partial, Time now);
  void take_one(Outgoing& packet, std::uint32_t index, Time now);
  void mark_overtaken();
  void mark_lost(Outgoing& packet, std::uint32_t index);
  void receiver_restarted();
  void probe();
  const Outgoing* unstarted() const;

  std::uint8_t stream_;
  std::size_t window_;
  bool tells_ends_;
  std::uint32_t next_number_;
  std::deque<Outgoing> packets_;
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
