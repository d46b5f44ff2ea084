// The hops to all neighbours: what waits for each, what is on its way, what is owed to it.
#pragma once

#include <optional>
#include <vector>

#include "air/transmitter.hpp"
#include "api/journal.hpp"
#include "busy_map.hpp"
#include "outbox.hpp"
#include "routing/neighbors.hpp"
#include "routing/robot_directory.hpp"
#include "transport/held_answers.hpp"
#include "transport/hop_receiver.hpp"
#include "transport/hop_sender.hpp"
#include "transport/passed_frames.hpp"
#include "transport/turn_taking.hpp"

namespace adhoc_communication::transport {

class Hops : public Outbox {
 public:
  Hops(const Identity& self, const EngineOptions& options, routing::Neighbors& neighbors,
       const routing::RobotDirectory& directory, air::AirClock& air, air::Transmitter& transmitter, Journal& journal,
       Statistics& statistics);

  void broadcast(wire::FrameType type, Bytes body, Time now) override;
  void unicast(const MacAddress& neighbor, wire::FrameType type, Bytes body) override;
  void unicast_once(const MacAddress& neighbor, wire::FrameType type, Bytes body, Time now) override;
  Time air_ready() const override { return air_.ready_at(); }

  /// A full queue loses the frame or another one; who sent it from end to end repeats it.
  void enqueue(const MacAddress& neighbor, HopFrame frame);

  // Frames in.
  void heard(const MacAddress& neighbor, Time now);
  /// Of a frame that wants an acknowledgment: whether it is new.
  bool take(const wire::FrameHeader& header, Time now);
  void on_acknowledgment(const MacAddress& from, const wire::HopAcknowledgment& acknowledgment, Time now);

  // What is due.
  /// The host called late: silence before now proves nothing.
  void excuse_silence(Time now);
  /// Returns the neighbours to which frames go unanswered.
  std::vector<MacAddress> expire(Time now);
  void acknowledge(Time now);
  Time next_deadline(Time now) const;
  void settle();

  // What goes on the air. Each sends one frame, or none if it may not or there is none.
  // They take one neighbour after the other.
  /// A frame that came from there, again.
  bool repeat_lost(std::uint8_t priority, const MacAddress& previous_hop, Time now);
  /// A frame that came from there.
  bool send_waiting(std::uint8_t priority, const MacAddress& previous_hop, Time now);
  /// Whether a frame may be started now.
  bool may_start(const MacAddress& neighbor, std::uint8_t priority, Time now);
  void start(const MacAddress& neighbor, HopFrame frame, Time now);
  /// From whom frames of that priority wait, to be sent or to be repeated.
  void add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const;
  /// Whether a frame would be sent if the air were free.
  bool something_to_send(Time now) const;
  bool has_room(const MacAddress& neighbor, std::uint8_t priority, Time now) const;

  /// What was not acknowledged.
  std::vector<HopFrame> take_all(const MacAddress& neighbor);
  void forget(const MacAddress& neighbor) { hops_.erase(neighbor); }
  /// Once in a while: neighbours that are gone are forgotten, the others' losses told.
  void maintain(Time now);

  bool idle(const MacAddress& neighbor) const;
  const HopSender* sender_to(const MacAddress& neighbor) const;
  std::size_t size() const { return hops_.size(); }

 private:
  struct Hop {
    HopSender sender;
    std::optional<HopReceiver> receiver;
    HeldAnswers held_answers;
    int pair = 0;  ///< counts frames; 0 and 1 are the pair that measures the air

    bool idle() const { return sender.settled() && (!receiver || receiver->due() == Time::max()); }
  };

  Hop& hop(const MacAddress& neighbor);
  AcknowledgmentDelays delays(const MacAddress& neighbor) const;
  bool passes_on(const MacAddress& neighbor) const;
  Time acknowledgment_due(const MacAddress& neighbor, const HopReceiver& receiver) const;
  bool air_allows(const MacAddress& neighbor, const Hop& hop, std::uint8_t priority, Time now) const;
  bool is_turn(const MacAddress& neighbor, std::uint8_t priority, Time now) const;
  bool wants_answer(const MacAddress& neighbor, Hop& hop, wire::FrameType type, Time now);
  void follow(const HopFrame& frame, const HopSender& next);
  void send_urgent(const MacAddress& neighbor, Hop& hop, Time now);
  static bool needs_turn(const Hop& hop, const HopSender::Outgoing& outgoing);
  static bool tries_turn(const Hop& hop, const HopSender::Outgoing& outgoing);
  bool ends_turn(const MacAddress& neighbor, const HopSender::Outgoing& outgoing, std::uint64_t counter, bool more,
                 Time now);
  void start(const MacAddress& neighbor, Hop& hop, HopFrame frame, Time now);
  void put_on_air(const MacAddress& neighbor, Hop& hop, const HopSender::Outgoing& outgoing, std::uint64_t counter,
                  Time now);

  const Identity& self_;
  const EngineOptions& options_;
  routing::Neighbors& neighbors_;
  air::AirClock& air_;
  air::Transmitter& transmitter_;
  Statistics& statistics_;
  PassedFrames passed_;
  BusyMap<Hop> hops_;
  TurnTaking turns_;
  MacAddress last_served_{};
};

}  // namespace adhoc_communication::transport
