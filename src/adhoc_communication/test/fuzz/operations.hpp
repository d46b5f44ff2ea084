// An input of fuzz_engine: operations one after the other, each with its operands. Reading never fails: an input that
// ends within an operation continues with zeros.
#pragma once

#include <algorithm>
#include <cstdint>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::fuzz {

enum class Operation : std::uint8_t {
  kFrame,    ///< whom, sender, type, flags, link sequence, length, body: heard under a good header and checksum
  kRaw,      ///< whom, length, octets: heard as they are
  kSend,     ///< who, destination, priority, size (2 octets)
  kFlood,    ///< who, hop limit, size
  kJoin,     ///< who, group
  kLeave,    ///< who, group
  kAdvance,  ///< milliseconds; what is due meanwhile is done
  kJump,     ///< tenths of a second without a call, as a host does that was suspended
  kLose,     ///< share of the frames between the engines that get lost, of 256
  kRestart,  ///< who
  kCount,
};

class Operands {
 public:
  Operands(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  bool at_end() const { return left_ == 0; }
  Operation operation() { return static_cast<Operation>(u8() % static_cast<std::uint8_t>(Operation::kCount)); }
  std::uint8_t u8() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  std::uint16_t u16() {
    const int high = u8();
    return static_cast<std::uint16_t>(high << 8 | u8());
  }
  Bytes octets(std::size_t size) {
    size = std::min(size, left_);
    Bytes bytes(data_, data_ + size);
    data_ += size;
    left_ -= size;
    return bytes;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace adhoc_communication::fuzz
