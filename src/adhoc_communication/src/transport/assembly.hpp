// One packet that is being put together from segments.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

/// Memory grows with what arrives.
class Assembly {
 public:
  static constexpr std::uint32_t kSegmentsAhead = 2048;  ///< taken beyond the first missing one

  Assembly(std::uint32_t total, std::uint16_t segment_size)
      : total_(total), segment_size_(segment_size), missing_((total + segment_size - 1) / segment_size) {}

  bool matches(std::uint32_t total, std::uint16_t segment_size) const {
    return total_ == total && segment_size_ == segment_size;
  }
  bool complete() const { return missing_ == 0; }
  std::uint32_t first_missing() const { return first_missing_; }
  /// How many segments are known of, arrived or not.
  std::uint32_t known() const { return static_cast<std::uint32_t>(present_.size()); }
  bool has(std::uint32_t index) const { return index < present_.size() && present_[index]; }

  /// True when the segment is new.
  bool take(std::uint32_t index, const Bytes& octets) {
    if (complete() || has(index) || (index > first_missing_ && index - first_missing_ >= kSegmentsAhead)) return false;
    const std::size_t begin = std::size_t{index} * segment_size_;
    if (begin + octets.size() > octets_.size()) octets_.resize(begin + octets.size());
    if (index >= present_.size()) present_.resize(index + 1);
    std::copy(octets.begin(), octets.end(), octets_.begin() + static_cast<std::ptrdiff_t>(begin));
    present_[index] = true;
    --missing_;
    while (first_missing_ < present_.size() && present_[first_missing_]) ++first_missing_;
    return true;
  }
  Bytes take_image() { return std::exchange(octets_, {}); }

 private:
  std::uint32_t total_;
  std::uint16_t segment_size_;
  std::uint32_t missing_;
  std::uint32_t first_missing_ = 0;
  std::vector<bool> present_;
  Bytes octets_;
};

}  // namespace adhoc_communication::transport
