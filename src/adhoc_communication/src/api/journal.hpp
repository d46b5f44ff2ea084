// What the host wants to write down and has not taken yet.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "adhoc_communication/records.hpp"

namespace adhoc_communication {

/// When it is full further records are lost and counted.
class Journal {
 public:
  static constexpr std::size_t kMostRecords = 4096;

  explicit Journal(bool kept) : kept_(kept) {}

  /// Whether anybody reads it: otherwise nothing is to be added.
  bool kept() const { return kept_; }
  void add(Time at, decltype(Record::what) what) {
    if (!kept_) return;
    if (records_.size() < kMostRecords) {
      records_.push_back({at, std::move(what)});
    } else {
      ++lost_;
    }
  }
  std::vector<Record> take() { return std::exchange(records_, {}); }
  std::size_t size() const { return records_.size(); }
  std::uint64_t lost() const { return lost_; }

 private:
  bool kept_;
  std::vector<Record> records_;
  std::uint64_t lost_ = 0;
};

}  // namespace adhoc_communication
