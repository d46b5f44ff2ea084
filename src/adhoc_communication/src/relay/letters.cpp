#include "relay/letters.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication {
namespace {

const char* const kLetterTopic = "definition";  // nobody publishes it, but a packet needs a topic

SendRequest letter(const std::string& robot, PayloadType type, Bytes payload) {
  return {robot, kLetterTopic, static_cast<std::uint8_t>(type), std::move(payload), Priority::kNormal};
}

}  // namespace

void Letters::ask(const std::string& robot, const TypeName& type) {
  const SerializedMessage question{type.type, type.md5sum, {}, {}, false};
  post(kQuestion, letter(robot, PayloadType::kDefinitionRequest, encode_message_by_type(question)));
}

void Letters::answer(const std::string& robot, const TypeName& type, const std::string& definition) {
  const SerializedMessage answer{type.type, type.md5sum, definition, {}, false};
  post(kAnswer, letter(robot, PayloadType::kDefinition, encode_any_message(answer)));
}

void Letters::post(Kind kind, SendRequest letter) {
  if (boxes_[kind].waiting.size() < kMostWaiting) boxes_[kind].waiting.push_back(std::move(letter));
}

std::optional<SendRequest> Letters::next(std::uint64_t number) {
  const auto box = std::find_if(boxes_.begin(), boxes_.end(), [](const Box& each) { return each.ready(); });
  if (box == boxes_.end()) return std::nullopt;
  SendRequest letter = std::move(box->waiting.front());
  box->waiting.pop_front();
  ++box->under_way;
  under_way_[number] = static_cast<Kind>(box - boxes_.begin());
  return letter;
}

bool Letters::ended(std::uint64_t number) {
  const auto found = under_way_.find(number);
  if (found == under_way_.end()) return false;
  --boxes_[found->second].under_way;
  under_way_.erase(found);
  return true;
}

bool Letters::ready() const {
  return std::any_of(boxes_.begin(), boxes_.end(), [](const Box& box) { return box.ready(); });
}

}  // namespace adhoc_communication
