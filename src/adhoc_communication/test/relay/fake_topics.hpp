// Local topics in memory, with subscribers as a test has them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "relay/local_topics.hpp"
#include "relay/topic_name.hpp"

namespace adhoc_communication {

class FakeTopics : public LocalTopics {
 public:
  std::map<std::string, std::size_t> expected;   ///< subscribers that a topic has or is to have
  std::map<std::string, std::size_t> connected;  ///< those that it has
  std::optional<std::set<std::string>> published_by_others{std::set<std::string>{}};
  bool answers = true;                           ///< at once
  int times_asked = 0;                           ///< what is in use
  std::set<std::string> pending;                 ///< topics that are not offered yet
  std::map<std::string, std::string> refused;    ///< those that never will be, and why
  std::map<std::string, bool> advertised;        ///< and whether they are latched
  std::vector<std::string> published;            ///< topic and octets
  std::set<std::string> slow;                    ///< topics of which something waits for a subscriber
  std::map<std::string, std::uint64_t> dropped;  ///< messages that slow ones have lost, not told yet

  std::string full_name(const std::string& topic) const override { return local_topic("/", topic); }
  void ask() override {
    ++times_asked;
    asked_ = true;
  }
  std::optional<Answer> take_answer() override {
    if (!answers || !std::exchange(asked_, false)) return std::nullopt;
    if (!published_by_others) return Answer{};
    return Answer{TopicsInUse{*published_by_others, expected}};
  }
  std::unique_ptr<Publication> advertise(const std::string& name, const SerializedMessage&, bool latched) override {
    advertised[name] = latched;
    return std::make_unique<FakePublication>(*this, name);
  }

 private:
  class FakePublication : public Publication {
   public:
    FakePublication(FakeTopics& topics, std::string name) : topics_(topics), name_(std::move(name)) {}
    ~FakePublication() override { topics_.advertised.erase(name_); }

    bool offered() const override { return topics_.pending.count(name_) == 0; }
    std::string refusal() const override {
      const auto found = topics_.refused.find(name_);
      return found == topics_.refused.end() ? "" : found->second;
    }
    std::size_t subscribers() const override { return topics_.connected[name_]; }
    void publish(const SerializedMessage& message) override {
      topics_.published.push_back(name_ + " " + std::string(message.bytes.begin(), message.bytes.end()));
    }
    bool serve() override { return topics_.slow.count(name_) != 0; }
    std::uint64_t take_dropped() override { return std::exchange(topics_.dropped[name_], 0); }

   private:
    FakeTopics& topics_;
    const std::string name_;
  };

  bool asked_ = false;
};

}  // namespace adhoc_communication
