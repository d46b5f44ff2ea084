// The tree of a group and the packets on it.
#include "wire/messages.hpp"

namespace adhoc_communication::wire {
namespace {

constexpr std::uint8_t kGroupStreamMask = 0x03;
constexpr std::uint8_t kByRouteFlag = 0x80;
constexpr std::uint8_t kReportFlag = 0x80;
constexpr std::uint8_t kFollowsFlag = 0x40;
constexpr std::uint8_t kFloodedFlag = 0x20;
constexpr std::uint8_t kCompleteFlag = 0x80;

template <typename Message>
void write_branch(Writer& writer, const Message& message) {
  writer.octets(message.root);
  writer.u64(message.root_boot);
  writer.u32(message.epoch);
  writer.u8(static_cast<std::uint8_t>(message.members.size()));
  for (const MacAddress& member : message.members) writer.octets(member);
}

template <typename Message>
std::optional<Message> read_branch(Reader& reader) {
  Message message;
  message.root = reader.individual_address();
  message.root_boot = reader.u64();
  message.epoch = reader.u32();
  for (int left = reader.u8(); left > 0 && reader.ok(); --left) {
    message.members.push_back(reader.individual_address());
  }
  if (!reader.at_end() || message.members.size() > kMostMembersOfActivation) return std::nullopt;
  return message;
}

}  // namespace

void write(Writer& writer, const GroupActivation& activation) { write_branch(writer, activation); }
void write(Writer& writer, const GroupRefusal& refusal) { write_branch(writer, refusal); }

std::optional<GroupActivation> read_group_activation(Reader reader) { return read_branch<GroupActivation>(reader); }

std::optional<GroupRefusal> read_group_refusal(Reader reader) {
  auto refusal = read_branch<GroupRefusal>(reader);
  if (refusal && refusal->members.empty()) return std::nullopt;
  return refusal;
}

void write(Writer& writer, const GroupData& data) {
  writer.octets(data.root);
  writer.u64(data.root_boot);
  writer.u8(static_cast<std::uint8_t>(data.stream | (data.report ? kReportFlag : 0) |
                                      (data.follows ? kFollowsFlag : 0) | (data.flooded ? kFloodedFlag : 0)));
  writer.u8(data.hops);
  writer.u16(data.round);
  writer.u32(data.packet);
  writer.u32(data.base);
  writer.u32(data.total);
  writer.u16(data.segment_size);
  writer.u16(data.block);
  writer.u8(data.symbol);
  writer.octets(data.octets);
}

std::optional<GroupData> read_group_data(Reader reader) {
  GroupData data;
  data.root = reader.individual_address();
  data.root_boot = reader.u64();
  const std::uint8_t stream = reader.u8();
  data.stream = stream & kGroupStreamMask;
  data.report = (stream & kReportFlag) != 0;
  data.follows = (stream & kFollowsFlag) != 0;
  data.flooded = (stream & kFloodedFlag) != 0;
  data.hops = reader.u8();
  data.round = reader.u16();
  data.packet = reader.u32();
  data.base = reader.u32();
  data.total = reader.u32();
  data.segment_size = reader.u16();
  data.block = reader.u16();
  data.symbol = reader.u8();
  data.octets = reader.rest();
  constexpr std::uint8_t kAll = kGroupStreamMask | kReportFlag | kFollowsFlag | kFloodedFlag;
  if (!reader.ok() || (stream & ~kAll) != 0) return std::nullopt;
  if (data.hops == 0 || data.hops > kFarthestHop || data.total == 0) return std::nullopt;
  if (data.segment_size < kShortestSegment || data.segment_size > kLongestSegment) return std::nullopt;
  if (data.octets.size() > data.segment_size || (data.octets.empty() && !data.report)) return std::nullopt;
  const bool whole = data.block == 0 && data.symbol == 0 && data.octets.size() == data.total;
  if (data.flooded && (data.report || !whole)) return std::nullopt;
  return data;
}

void write(Writer& writer, const GroupReport& report) {
  writer.octets(report.root);
  writer.u64(report.root_boot);
  writer.u8(static_cast<std::uint8_t>(report.stream | (report.complete ? kCompleteFlag : 0)));
  writer.u32(report.packet);
  writer.u32(report.epoch);
  writer.u16(report.round);
  writer.u64(report.measured_counter);
  writer.u32(report.spacing_ns);
  writer.u32(report.coverage);
  writer.u16(report.first_block);
  writer.octets(report.missing);
}

std::optional<GroupReport> read_group_report(Reader reader) {
  GroupReport report;
  report.root = reader.individual_address();
  report.root_boot = reader.u64();
  const std::uint8_t stream = reader.u8();
  report.stream = stream & kGroupStreamMask;
  report.complete = (stream & kCompleteFlag) != 0;
  report.packet = reader.u32();
  report.epoch = reader.u32();
  report.round = reader.u16();
  report.measured_counter = reader.u64();
  report.spacing_ns = reader.u32();
  report.coverage = reader.u32();
  report.first_block = reader.u16();
  report.missing = reader.rest();
  if (!reader.ok() || (stream & ~(kGroupStreamMask | kCompleteFlag)) != 0) return std::nullopt;
  if (report.missing.size() > kMostBlocksOfReport) return std::nullopt;
  return report;
}

void write(Writer& writer, const GroupReceipts& receipts) {
  writer.u8(static_cast<std::uint8_t>(receipts.receipts.size()));
  for (const GroupReceipt& receipt : receipts.receipts) {
    writer.octets(receipt.root);
    writer.u64(receipt.root_boot);
    writer.u8(static_cast<std::uint8_t>(receipt.stream | (receipt.by_route ? kByRouteFlag : 0)));
    writer.octets(receipt.member);
    writer.u32(receipt.next);
    writer.u32(receipt.beyond);
  }
}

std::optional<GroupReceipts> read_group_receipts(Reader reader) {
  GroupReceipts receipts;
  for (int left = reader.u8(); left > 0 && reader.ok(); --left) {
    GroupReceipt receipt;
    receipt.root = reader.individual_address();
    receipt.root_boot = reader.u64();
    const std::uint8_t stream = reader.u8();
    receipt.stream = stream & kGroupStreamMask;
    receipt.by_route = (stream & kByRouteFlag) != 0;
    receipt.member = reader.individual_address();
    receipt.next = reader.u32();
    receipt.beyond = reader.u32();
    if ((stream & ~(kGroupStreamMask | kByRouteFlag)) != 0) return std::nullopt;
    receipts.receipts.push_back(receipt);
  }
  const std::size_t count = receipts.receipts.size();
  if (!reader.at_end() || count == 0 || count > kMostReceipts) return std::nullopt;
  return receipts;
}

}  // namespace adhoc_communication::wire
