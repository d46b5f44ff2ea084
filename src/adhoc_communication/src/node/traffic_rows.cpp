#include "node/traffic_rows.hpp"

#include <numeric>

#include "node/csv_row.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

using wire::FrameType;

constexpr int kNothing = 0;  // cooperative relaying, and what trees do without

std::uint64_t of(const Statistics::ByType& counts, FrameType type) { return counts[static_cast<std::size_t>(type)]; }

std::uint64_t of_groups(const Statistics::ByType& counts) {
  return of(counts, FrameType::kGroupActivation) + of(counts, FrameType::kGroupRefusal) +
         of(counts, FrameType::kGroupData) + of(counts, FrameType::kGroupReport) +
         of(counts, FrameType::kGroupReceipts);
}

std::uint64_t of_others(const Statistics::ByType& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}) - of_groups(counts);
}

std::uint64_t acknowledgments(const Statistics::ByType& counts) {
  return of(counts, FrameType::kHopAcknowledgment) + of(counts, FrameType::kTransportAcknowledgment);
}

}  // namespace

std::string unicast_row(const Statistics& statistics, long long time) {
  const Statistics::ByType& sent = statistics.frames_sent_by_type;
  const Statistics::ByType& received = statistics.frames_received_by_type;
  const DataFrames& data = statistics.unicast_data;
  const std::string out =
      csv_row(data.sent, data.passed_on, data.sent_again, data.passed_on_again, kNothing, acknowledgments(sent),
              kNothing, of(sent, FrameType::kRouteRequest), of(sent, FrameType::kRouteReply),
              of(sent, FrameType::kBeacon), kNothing, kNothing, of_others(sent));
  const std::string in =
      csv_row(data.received, kNothing, of(received, FrameType::kData), kNothing, acknowledgments(received), kNothing,
              of(received, FrameType::kRouteRequest), of(received, FrameType::kRouteReply), kNothing, kNothing,
              statistics.frames_received_again, of(received, FrameType::kBeacon), of_others(received));
  return std::to_string(time) + ',' + out + ',' + in + ',' +
         csv_row(of_others(statistics.bytes_sent_by_type), of_others(statistics.bytes_received_by_type));
}

std::string multicast_row(const Statistics& statistics, long long time) {
  const Statistics::ByType& sent = statistics.frames_sent_by_type;
  const Statistics::ByType& received = statistics.frames_received_by_type;
  const DataFrames& data = statistics.group_data;
  const std::string out = csv_row(data.sent, data.passed_on, data.sent_again, data.passed_on_again, kNothing,
                                  of(sent, FrameType::kGroupReport) + of(sent, FrameType::kGroupReceipts), kNothing,
                                  kNothing, kNothing, of(sent, FrameType::kGroupActivation), kNothing, of_groups(sent));
  const std::string in = csv_row(data.received, kNothing, of(received, FrameType::kGroupData), kNothing,
                                 of(received, FrameType::kGroupReport) + of(received, FrameType::kGroupReceipts),
                                 kNothing, kNothing, kNothing, of(received, FrameType::kGroupActivation), kNothing,
                                 of(received, FrameType::kGroupData) - data.received, of_groups(received));
  return std::to_string(time) + ',' + out + ',' + in + ',' +
         csv_row(of_groups(statistics.bytes_sent_by_type), of_groups(statistics.bytes_received_by_type));
}

}  // namespace adhoc_communication
