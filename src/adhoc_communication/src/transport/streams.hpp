// Own packets on their way to one robot each: a stream for each robot and priority.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "busy_map.hpp"
#include "routing/router.hpp"
#include "transport/hops.hpp"
#include "transport/stream_sender.hpp"

namespace adhoc_communication::transport {

/// A packet that is given up, and why.
struct Undelivered {
  SendId id;
  std::string reason;
};

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
  Time next_deadline() const;

  /// Sends one segment if it may; one destination after the other.
  bool send_segment(std::uint8_t priority, Time now);
  /// Whether a segment would be sent if the air were free.
  bool something_to_send() const;

  std::size_t size() const { return streams_.size(); }

 private:
  struct Stream {
    StreamSender sender;
    std::optional<MacAddress> address;
    std::optional<MacAddress> next_hop;
  };
  using Key = std::pair<std::string, std::uint8_t>;

  Stream* find(const std::string& destination, Priority priority);
  void serve(const Key& key, Stream& stream, std::vector<Undelivered>& undelivered, Time now);
  void record(const Key& key, Stream& stream, Time now);
  bool send_segment(const Key& key, Stream& stream, Time now);

  const Identity& self_;
  const EngineOptions& options_;
  const routing::RobotDirectory& directory_;
  routing::Router& router_;
  Hops& hops_;
  Random& random_;
  Journal& journal_;
  std::uint16_t segment_size_;
  BusyMap<Key, Stream> streams_;
  Key last_served_;
  bool news_ = false;
};

}  // namespace adhoc_communication::transport
