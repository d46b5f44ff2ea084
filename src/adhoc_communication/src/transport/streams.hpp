// Own packets on their way to one robot each: a stream for each robot and priority.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "deadlines.hpp"
#include "routing/router.hpp"
#include "transport/hops.hpp"
#include "transport/ready_streams.hpp"
#include "transport/stream_sender.hpp"

namespace adhoc_communication::transport {

/// A packet that is given up, and why.
struct Undelivered {
  SendId id;
  std::string reason;
};

/// Looks at a stream when something has happened to it or to its route, or when a timer of it has run out.
class Streams {
 public:
  static constexpr std::size_t kMostStreams = 1024;  ///< robots and priorities; idle ones make room

  Streams(const Identity& self, const EngineOptions& options, const routing::RobotDirectory& directory,
          routing::Router& router, Hops& hops, Random& random, Journal& journal, std::size_t segment_size);

  void add(SendId id, const std::string& destination, Image image, Priority priority, Time now);
  /// Puts another packet in the place of one of which nothing was ever sent. False if there is no such packet.
  bool replace(const std::string& destination, Priority priority, SendId former, SendId id, const Image& image,
               Time now);
  void drop(const std::string& destination, Priority priority, SendId id, Time now);
  /// Packets were added since the last call.
  bool take_news() { return std::exchange(news_, false); }
  bool has_news() const { return news_; }

  /// Returns the packets that have arrived.
  std::vector<SendId> acknowledged(const wire::TransportAcknowledgment& acknowledgment, Time now);
  /// Keeps routes and end-to-end timers of streams with work.
  std::vector<Undelivered> serve(Time now);
  /// There is no way to the robot: returns all packets for it.
  std::vector<SendId> abandon(const std::string& destination, Time now);
  /// Own packets to the robot may have waited for that repair: a search begins.
  void repair_failed(const MacAddress& destination);
  Time next_deadline() const { return timers_.next(); }

  /// Sends one segment if it may; one destination after the other.
  bool send_segment(std::uint8_t priority, Time now);
  /// Whether a segment would be sent if the air were free.
  bool something_to_send(Time now) const;

  std::size_t size() const { return streams_.size(); }

 private:
  using Key = std::pair<std::string, std::uint8_t>;
  struct Stream {
    Key key;
    StreamSender sender;
    std::optional<MacAddress> address{};
    std::optional<MacAddress> next_hop{};
    std::uint8_t beyond = 0;  ///< hops that the next hop leaves
  };

  Stream* find(const std::string& destination, std::uint8_t priority);
  void note_changes();
  void note(const std::string& destination);
  Time serve(Stream& stream, std::vector<Undelivered>& undelivered, Time now);
  void record(Stream& stream, Time now);
  void changed(Stream& stream);
  void sort_in(Stream& stream);
  void send_segment(Stream& stream, Time now);
  void forget_idle();

  const Identity& self_;
  const EngineOptions& options_;
  const routing::RobotDirectory& directory_;
  routing::Router& router_;
  Hops& hops_;
  Random& random_;
  Journal& journal_;
  std::uint16_t segment_size_;
  std::map<Key, Stream> streams_;
  std::map<Key, Stream*> busy_;  ///< with packets, or with ends of segments to be told
  std::set<Key> changed_;        ///< to be looked at the next time
  ReadyStreams<Stream> ready_;
  Deadlines<Stream*> timers_;  ///< when something happens by itself
  Deadlines<Stream*> look_again_;
  Key last_served_;
  std::uint64_t directory_version_ = 0;
  bool news_ = false;
};

}  // namespace adhoc_communication::transport
