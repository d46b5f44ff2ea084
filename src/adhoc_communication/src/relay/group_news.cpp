#include "relay/group_news.hpp"

#include <algorithm>

#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

const char* const kTopic = "new_member";  // nobody publishes it, but a packet needs a topic

}  // namespace

void GroupNews::heard(const PacketReceived& packet) {
  const auto type = static_cast<PayloadType>(packet.payload_type);
  const bool relayed = type == PayloadType::kAnyMessage || type == PayloadType::kMessageByType;
  if (packet.latched && relayed && sources_.size() < kMostSources) sources_.insert(packet.source);
}

void GroupNews::joined(const std::string& member, Time now) {
  for (const std::string& source : sources_) {
    if (source != member && due_.size() < kMostWords) due_.emplace(Word(source, member), now);
  }
}

void GroupNews::left(const std::string& member) {
  drop([&member](const Word& word) { return word.second == member; });
}

void GroupNews::lost(const std::string& robot) {
  sources_.erase(robot);
  drop([&robot](const Word& word) { return word.first == robot || word.second == robot; });
}

template <typename Predicate>
void GroupNews::drop(Predicate concerns) {
  for (auto word = due_.begin(); word != due_.end();) word = concerns(word->first) ? due_.erase(word) : std::next(word);
  for (auto& [number, under_way] : under_way_) {
    if (concerns(under_way.word)) under_way.of_use = false;
  }
}

std::optional<SendRequest> GroupNews::next(std::uint64_t number, Time now) {
  if (under_way_.size() >= kMostUnderWay) return std::nullopt;
  const auto word = std::find_if(due_.begin(), due_.end(), [now](const auto& item) { return item.second <= now; });
  if (word == due_.end()) return std::nullopt;
  const auto [source, member] = word->first;
  under_way_.emplace(number, UnderWay{word->first});
  due_.erase(word);
  return SendRequest{source, kTopic, static_cast<std::uint8_t>(PayloadType::kNewMember),
                     Bytes(member.begin(), member.end()), Priority::kNormal};
}

bool GroupNews::ended(std::uint64_t number, bool delivered, Time now) {
  const auto found = under_way_.find(number);
  if (found == under_way_.end()) return false;
  if (!delivered && found->second.of_use) due_.emplace(found->second.word, now + kRetry);
  under_way_.erase(found);
  return true;
}

Time GroupNews::next_deadline() const {
  if (under_way_.size() >= kMostUnderWay) return Time::max();
  Time next = Time::max();
  for (const auto& [word, due] : due_) next = std::min(next, due);
  return next;
}

std::string GroupNews::member_in(const PacketReceived& word) {
  std::string member(word.payload.begin(), word.payload.end());
  if (!wire::is_name(member)) throw PayloadError("names no member of mc_" + word.source);
  return member;
}

}  // namespace adhoc_communication
