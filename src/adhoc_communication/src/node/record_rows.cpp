#include "node/record_rows.hpp"

#include "node/csv_row.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr int kUnicast = 0;  // in columns called multicast

/// What there is of a route: its next hop and its end, or that alone where the route has one hop.
std::string route_text(const RouteEnds& route) {
  if (route.hops == 0) return {};
  if (route.next_hop == route.destination) return address_text(route.destination);
  return address_text(route.next_hop) + '|' + address_text(route.destination);
}

/// The same the other way round.
std::string way_text(const RouteEnds& back) {
  if (back.next_hop == back.destination) return address_text(back.destination);
  return address_text(back.destination) + '|' + address_text(back.next_hop);
}

class Rows {
 public:
  Rows(Time at, long long epoch) : epoch_(epoch), at_(unix(at)) {}

  std::string operator()(const SegmentEnded& segment) const {
    const std::string id = std::to_string(segment.packet) + '/' + std::to_string(segment.index);
    return csv_row(at_, id, segment.destination, segment.repetitions, unix(segment.sent), unix(segment.ended),
                   segment.delivered, int{segment.route.hops}, route_text(segment.route), kUnicast);
  }

  std::string operator()(const FramePassed& frame) const {
    return csv_row(at_, frame.source, frame.link_sequence, address_text(frame.sender), address_text(frame.neighbor),
                   unix(frame.sent), unix(frame.acknowledged), frame.repetitions);
  }

  std::string operator()(const SearchEnded& search) const {
    const bool found = search.route.hops > 0;
    const std::string end = found ? std::to_string(unix(search.ended)) : "";
    const std::string hops = found ? std::to_string(search.route.hops) : "";
    return csv_row(at_, search.request, search.destination, unix(search.began), end, search.replies, search.requests,
                   hops, route_text(search.route), kUnicast);
  }

  std::string operator()(const RequestArrived& request) const {
    return csv_row(at_, request.request, request.originator, request.copies, int{request.back.hops}, request.answered,
                   way_text(request.back));
  }

  std::string operator()(const RequestPassedOn& request) const {
    return csv_row(at_, request.request, request.originator, address_text(request.from));
  }

 private:
  long long unix(Time time) const { return epoch_ + time / std::chrono::milliseconds(1); }

  long long epoch_;
  long long at_;
};

}  // namespace

std::string row_of(const Record& record, long long epoch) { return std::visit(Rows(record.at, epoch), record.what); }

}  // namespace adhoc_communication
