#include "api/sends.hpp"

#include <algorithm>

#include "adhoc_communication/packet_size.hpp"
#include "multicast/groups.hpp"
#include "texts.hpp"
#include "transport/packet_image.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {

std::size_t packet_size(const SendRequest& request) {
  const std::size_t payload = std::max<std::size_t>(request.payload.size(), request.unpacked_size);
  std::size_t size = transport::image_size(request.destination, request.topic, payload);
  if (multicast::root_of(request.destination)) size += transport::image_size(request.destination, {}, 5);  // as a copy
  return size;
}

std::string Sends::refusal(const SendRequest& request) const {
  if (request.destination == self_) return "the destination " + request.destination + " is this robot itself";
  const std::string robot = multicast::root_of(request.destination).value_or(request.destination);
  if (!robot.empty() && !wire::is_name(robot)) return no_name_text(robot);
  if (request.lifetime < Time(0)) return "the lifetime is negative";
  if (request.topic.empty()) return "the topic is empty";
  if (request.topic.size() > 65535) return "the topic is longer than 65535 octets";
  const std::size_t size = packet_size(request);
  if (size > max_packet_size_) {
    return "packet of " + size_text(size) + " exceeds max_packet_size of " + size_text(max_packet_size_);
  }
  if (host_sends_ >= kMostSends) return "send queue is full (" + std::to_string(host_sends_) + " packets waiting)";
  if (octets_waiting_ + request.payload.size() > kMostSendOctets && host_sends_ > 0) {
    return "send queue is full (" + size_text(octets_waiting_) + " waiting, at most " + size_text(kMostSendOctets) +
           ")";
  }
  return {};
}

SendId Sends::begin(transport::Sending sending, Time now) {
  const SendId id = take_id();
  if (sending.purpose == transport::Purpose::kHost) {
    ++host_sends_;
    octets_waiting_ += sending.octets;
  }
  if (sending.lifetime > Time(0)) terms_.expire_at(id, now + sending.lifetime);
  sendings_.emplace(id, std::move(sending));
  return id;
}

std::optional<transport::Sending> Sends::end(SendId id) {
  auto ended = sendings_.extract(id);
  if (!ended) return std::nullopt;
  terms_.end(id);
  if (ended.mapped().purpose == transport::Purpose::kHost) {
    --host_sends_;
    octets_waiting_ -= ended.mapped().octets;
  }
  return std::move(ended.mapped());
}

std::optional<SendId> Sends::make_newest(SendId id, const std::string& topic) {
  const transport::SendTerms::Subject subject{at(id).destination, topic};
  const auto former = terms_.newest(subject);
  terms_.make_newest(id, subject);
  return former;
}

std::vector<SendId> Sends::parts_of(SendId parent) const {
  std::vector<SendId> parts;
  for (const auto& [id, sending] : sendings_) {
    if (sending.purpose == transport::Purpose::kFanOut && sending.parent == parent) parts.push_back(id);
  }
  return parts;
}

std::optional<SendId> Sends::first() const {
  return sendings_.empty() ? std::nullopt : std::optional(sendings_.begin()->first);
}

std::size_t Sends::waiting_for_groups() const {
  return static_cast<std::size_t>(std::count_if(sendings_.begin(), sendings_.end(), [](const auto& item) {
    return item.second.purpose == transport::Purpose::kHost && multicast::root_of(item.second.destination);
  }));
}

}  // namespace adhoc_communication
