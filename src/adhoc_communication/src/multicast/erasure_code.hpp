// Cauchy Reed-Solomon over GF(256), by ISA-L: any k of the symbols of a block give back its k frames.
#pragma once

#include <cstdint>
#include <vector>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::multicast {

/// A block has `frames` source symbols, numbered from 0; those from `frames` to 255 are parity.
constexpr int kMostFramesOfBlock = 128;
constexpr int kSymbols = 256;

/// The parity symbol `symbol` (>= frames.size()) of equally long frames.
Bytes parity(const std::vector<const std::uint8_t*>& frames, std::size_t length, int symbol);

struct ParitySymbol {
  int symbol;
  const std::uint8_t* octets;
};

/// Computes the frames that are null in `frames` from as many parity symbols, in order of their index.
std::vector<Bytes> recover(const std::vector<const std::uint8_t*>& frames, std::size_t length,
                           const std::vector<ParitySymbol>& parities);

}  // namespace adhoc_communication::multicast
