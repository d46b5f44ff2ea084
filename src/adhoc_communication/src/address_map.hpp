// A table by hardware address that is looked into for every frame.
#pragma once

#include <algorithm>
#include <boost/iterator/indirect_iterator.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// As std::map<MacAddress, Value>: in the order of the addresses, and an entry stays where it is as long as it exists.
/// The addresses lie together, apart from what they stand for, so that a search touches little memory. Iterators hold
/// until the next change.
template <typename Value>
class AddressMap {
 public:
  using key_type = MacAddress;
  using value_type = std::pair<const MacAddress, Value>;

 private:
  using Entries = std::vector<std::unique_ptr<value_type>>;

 public:
  using iterator = boost::indirect_iterator<typename Entries::iterator>;
  using const_iterator = boost::indirect_iterator<typename Entries::const_iterator, const value_type>;

  std::size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  iterator begin() { return iterator(entries_.begin()); }
  iterator end() { return iterator(entries_.end()); }
  const_iterator begin() const { return const_iterator(entries_.begin()); }
  const_iterator end() const { return const_iterator(entries_.end()); }

  iterator find(const MacAddress& address) { return begin() + place_of_known(address); }
  const_iterator find(const MacAddress& address) const { return begin() + place_of_known(address); }
  std::size_t count(const MacAddress& address) const { return find(address) == end() ? 0 : 1; }
  const_iterator upper_bound(const MacAddress& address) const { return begin() + place_behind(address); }
  iterator upper_bound(const MacAddress& address) { return begin() + place_behind(address); }
  /// Throws std::out_of_range.
  Value& at(const MacAddress& address) {
    const iterator found = find(address);
    if (found == end()) throw std::out_of_range("address not in the table");
    return found->second;
  }
  const Value& at(const MacAddress& address) const { return const_cast<AddressMap*>(this)->at(address); }

  /// The entry, and whether it is new; one that was there stays as it is.
  std::pair<iterator, bool> emplace(const MacAddress& address, Value value) {
    const std::ptrdiff_t place = place_of(address);
    const bool is_new = !is_at(place, address);
    if (is_new) {
      entries_.insert(entries_.begin() + place, std::make_unique<value_type>(address, std::move(value)));
      numbers_.insert(numbers_.begin() + place, address.number());
    }
    return {begin() + place, is_new};
  }
  Value& operator[](const MacAddress& address) {
    const std::ptrdiff_t place = place_of(address);
    return is_at(place, address) ? entries_[static_cast<std::size_t>(place)]->second
                                 : emplace(address, Value{}).first->second;
  }
  /// Returns the entry behind.
  iterator erase(iterator entry) {
    const std::ptrdiff_t place = entry - begin();
    numbers_.erase(numbers_.begin() + place);
    return iterator(entries_.erase(entry.base()));
  }
  void erase(const MacAddress& address) {
    if (const iterator found = find(address); found != end()) erase(found);
  }

 private:
  std::ptrdiff_t place_of(const MacAddress& address) const {
    if (!is_at(last_, address)) last_ = place_near(last_, address.number());
    return last_;
  }
  /// Who asks for many does so in their order: it is mostly a little behind the one before.
  std::ptrdiff_t place_near(std::ptrdiff_t before, std::uint64_t number) const {
    const auto size = static_cast<std::ptrdiff_t>(numbers_.size());
    const auto end = std::min(before + kNear, size);
    auto begin = numbers_.begin();
    if (before < size && begin[before] < number) {
      for (std::ptrdiff_t place = before + 1; place < end; ++place) {
        if (begin[place] >= number) return place;
      }
      begin += before + 1;
    }
    return std::lower_bound(begin, numbers_.end(), number) - numbers_.begin();
  }
  std::ptrdiff_t place_behind(const MacAddress& address) const {
    return std::upper_bound(numbers_.begin(), numbers_.end(), address.number()) - numbers_.begin();
  }
  bool is_at(std::ptrdiff_t place, const MacAddress& address) const {
    return place < static_cast<std::ptrdiff_t>(numbers_.size()) &&
           numbers_[static_cast<std::size_t>(place)] == address.number();
  }
  /// That of end() if it is not there.
  std::ptrdiff_t place_of_known(const MacAddress& address) const {
    const std::ptrdiff_t place = place_of(address);
    return is_at(place, address) ? place : static_cast<std::ptrdiff_t>(numbers_.size());
  }

  static constexpr std::ptrdiff_t kNear = 5;

  std::vector<std::uint64_t> numbers_;  ///< of the addresses, rising
  Entries entries_;                     ///< in the same order
  mutable std::ptrdiff_t last_ = 0;     ///< looked for last: mostly the next question is the same
};

}  // namespace adhoc_communication
