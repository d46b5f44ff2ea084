// A table by hardware address of which most entries have nothing to do at any time.
#pragma once

#include <boost/container/flat_map.hpp>
#include <cstddef>
#include <utility>

#include "address_map.hpp"

namespace adhoc_communication {

/// Whoever gives an entry something to do calls use(); work is looked for among the busy ones only, in the order of
/// their addresses; nobody may become busy meanwhile. An entry stays where it is as long as it exists.
template <typename Value>
class BusyMap {
 public:
  using Busy = boost::container::flat_map<MacAddress, Value*>;

  BusyMap() = default;
  BusyMap(const BusyMap&) = delete;
  BusyMap& operator=(const BusyMap&) = delete;

  std::size_t size() const { return entries_.size(); }
  const AddressMap<Value>& all() const { return entries_; }
  const Value* find(const MacAddress& address) const {
    const auto found = entries_.find(address);
    return found == entries_.end() ? nullptr : &found->second;
  }
  Value* find(const MacAddress& address) { return const_cast<Value*>(std::as_const(*this).find(address)); }

  /// The entry, made by `make` if there is none.
  template <typename Make>
  Value& use(const MacAddress& address, Make make) {
    if (const auto found = busy_.find(address); found != busy_.end()) return *found->second;
    auto entry = entries_.find(address);
    if (entry == entries_.end()) entry = entries_.emplace(address, make()).first;
    busy_.emplace(address, &entry->second);
    return entry->second;
  }
  void erase(const MacAddress& address) {
    busy_.erase(address);
    entries_.erase(address);
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
  bool is_busy(const MacAddress& address) const { return busy_.count(address) != 0; }
  /// Those for which `idle` holds are busy no more.
  template <typename Predicate>
  void settle(Predicate idle) {
    for (auto entry = busy_.begin(); entry != busy_.end();) {
      entry = idle(*entry->second) ? busy_.erase(entry) : std::next(entry);
    }
  }

 private:
  AddressMap<Value> entries_;
  Busy busy_;
};

}  // namespace adhoc_communication
