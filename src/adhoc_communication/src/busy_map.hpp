// A map of which most entries have nothing to do at any time.
#pragma once

#include <cstddef>
#include <map>
#include <utility>

namespace adhoc_communication {

/// Whoever gives an entry something to do calls use(); work is looked for among the busy ones only, in the order of
/// their keys. An entry stays where it is as long as it exists.
template <typename Key, typename Value>
class BusyMap {
 public:
  using Busy = std::map<Key, Value*>;

  BusyMap() = default;
  BusyMap(const BusyMap&) = delete;
  BusyMap& operator=(const BusyMap&) = delete;

  std::size_t size() const { return entries_.size(); }
  const std::map<Key, Value>& all() const { return entries_; }
  const Value* find(const Key& key) const {
    const auto found = entries_.find(key);
    return found == entries_.end() ? nullptr : &found->second;
  }
  Value* find(const Key& key) { return const_cast<Value*>(std::as_const(*this).find(key)); }

  /// The entry, made by `make` if there is none.
  template <typename Make>
  Value& use(const Key& key, Make make) {
    if (const auto found = busy_.find(key); found != busy_.end()) return *found->second;
    auto entry = entries_.find(key);
    if (entry == entries_.end()) entry = entries_.emplace(key, make()).first;
    busy_.emplace(key, &entry->second);
    return entry->second;
  }
  void erase(const Key& key) {
    busy_.erase(key);
    entries_.erase(key);
  }
  template <typename Predicate>
  void erase_if(Predicate condition) {
    for (auto entry = entries_.begin(); entry != entries_.end();) {
      const bool goes = condition(entry->first, entry->second);
      if (goes) busy_.erase(entry->first);
      entry = goes ? entries_.erase(entry) : std::next(entry);
    }
  }

  const Busy& busy() const { return busy_; }
  bool is_busy(const Key& key) const { return busy_.count(key) != 0; }
  /// Those for which `idle` holds are busy no more.
  template <typename Predicate>
  void settle(Predicate idle) {
    for (auto entry = busy_.begin(); entry != busy_.end();) {
      entry = idle(*entry->second) ? busy_.erase(entry) : std::next(entry);
    }
  }

 private:
  std::map<Key, Value> entries_;
  Busy busy_;
};

}  // namespace adhoc_communication
