// The packets that are not finished yet: their numbers, their bounds, when they end at the latest.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "transport/send_terms.hpp"
#include "transport/sending.hpp"

namespace adhoc_communication {

class Sends {
 public:
  static constexpr std::size_t kMostSends = 256;              ///< packets of the host
  static constexpr std::size_t kMostSendOctets = 64'000'000;  ///< of these packets, as they go on the air

  /// `self`: the robot's own name.
  Sends(std::string self, std::size_t max_packet_size) : self_(std::move(self)), max_packet_size_(max_packet_size) {}

  /// Why a request cannot be tried at all; empty if it can.
  std::string refusal(const SendRequest& request) const;
  /// A number for something that ends at once.
  SendId take_id() { return next_id_++; }
  SendId next_id() const { return next_id_; }
  /// `sending` begins.
  SendId begin(transport::Sending sending, Time now);
  /// Nothing if it has ended before.
  std::optional<transport::Sending> end(SendId id);

  const transport::Sending& at(SendId id) const { return sendings_.at(id); }
  /// The send of the same destination and topic that this newest one may take the place of.
  std::optional<SendId> make_newest(SendId id, const std::string& topic);
  std::vector<SendId> overdue(Time now) const { return terms_.overdue(now); }
  Time next_deadline() const { return terms_.next_deadline(); }
  /// Those that carry parts of a send to a group.
  std::vector<SendId> parts_of(SendId parent) const;
  /// Any one; nothing if there is none.
  std::optional<SendId> first() const;

  /// Of the host.
  std::size_t waiting() const { return host_sends_; }
  std::size_t octets_waiting() const { return octets_waiting_; }
  std::size_t waiting_for_groups() const;
  std::size_t most_octets() const { return kMostSendOctets + max_packet_size_; }

  /// Numbers go on from those of a former run.
  void succeed(const Sends& former) { next_id_ = former.next_id_; }

 private:
  std::string self_;
  std::size_t max_packet_size_;
  std::map<SendId, transport::Sending> sendings_;
  transport::SendTerms terms_;
  std::size_t host_sends_ = 0;
  std::size_t octets_waiting_ = 0;
  SendId next_id_ = 1;
};

}  // namespace adhoc_communication
