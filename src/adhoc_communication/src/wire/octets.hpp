// Reading and writing octet strings in network byte order (RFC 3561 section 5). Reading never runs over the end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::wire {

/// First eight octets of a boot id: enough to tell the runs of one robot apart inside a frame.
using BootTag = std::uint64_t;

class Writer {
 public:
  explicit Writer(Bytes& bytes) : bytes_(bytes) {}

  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value) { unsigned_number(value, 2); }
  void u32(std::uint32_t value) { unsigned_number(value, 4); }
  void u64(std::uint64_t value) { unsigned_number(value, 8); }
  void octets(const std::uint8_t* data, std::size_t size) { bytes_.insert(bytes_.end(), data, data + size); }
  void octets(const Bytes& data) { octets(data.data(), data.size()); }
  template <std::size_t N>
  void octets(const std::array<std::uint8_t, N>& data) {
    octets(data.data(), N);
  }
  /// One octet of length, then at most 255 octets of text.
  void text8(std::string_view text) {
    text = text.substr(0, 255);
    u8(static_cast<std::uint8_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  /// Two octets of length, then at most 65535 octets of text.
  void text16(std::string_view text) {
    text = text.substr(0, 65535);
    u16(static_cast<std::uint16_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }

 private:
  void unsigned_number(std::uint64_t value, int octets) {
    for (int shift = 8 * (octets - 1); shift >= 0; shift -= 8) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
    }
  }

  Bytes& bytes_;
};

/// Once a read asks for more than is left, ok() is false and every further read yields zeros.
class Reader {
 public:
  Reader(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  explicit Reader(const Bytes& bytes) : Reader(bytes.data(), bytes.size()) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(unsigned_number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(unsigned_number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(unsigned_number(4)); }
  std::uint64_t u64() { return unsigned_number(8); }
  template <std::size_t N>
  std::array<std::uint8_t, N> octets() {
    std::array<std::uint8_t, N> value{};
    if (const std::uint8_t* from = take(N)) std::copy(from, from + N, value.begin());
    return value;
  }
  MacAddress address() { return {octets<6>()}; }
  /// The address of one station: not ok() where it is null or a group's.
  MacAddress individual_address() {
    const MacAddress read = address();
    if (read == MacAddress{} || (read[0] & 0x01) != 0) ok_ = false;
    return read;
  }
  std::string text8() { return text(u8()); }
  std::string text16() { return text(u16()); }
  Bytes rest() {
    const std::size_t size = left_;
    const std::uint8_t* from = take(size);
    return from == nullptr ? Bytes{} : Bytes(from, from + size);
  }
  void skip(std::size_t size) { take(size); }

  bool ok() const { return ok_; }
  bool at_end() const { return ok_ && left_ == 0; }
  std::size_t left() const { return left_; }

 private:
  const std::uint8_t* take(std::size_t size) {
    if (!ok_ || size > left_) {
      ok_ = false;
      left_ = 0;
      return nullptr;
    }
    const std::uint8_t* from = data_;
    data_ += size;
    left_ -= size;
    return from;
  }
  std::uint64_t unsigned_number(std::size_t octets) {
    const std::uint8_t* from = take(octets);
    std::uint64_t value = 0;
    for (std::size_t i = 0; from != nullptr && i < octets; ++i) value = value << 8 | from[i];
    return value;
  }
  std::string text(std::size_t size) {
    const std::uint8_t* from = take(size);
    return from == nullptr ? std::string{} : std::string(from, from + size);
  }

  const std::uint8_t* data_;
  std::size_t left_;
  bool ok_ = true;
};

inline BootTag boot_tag(const BootId& boot_id) { return Reader(boot_id.data(), 8).u64(); }

}  // namespace adhoc_communication::wire
