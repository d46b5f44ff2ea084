// Contents of packets for tests and benchmarks.
#pragma once

#include <string>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// `size` octets that no compression shortens, different for each seed.
Bytes noise(std::size_t size, std::uint64_t seed = 1);
/// `size` octets like a map: long runs of few values.
Bytes map_like(std::size_t size);
Bytes text(const std::string& characters);
std::string text(const Bytes& octets);

}  // namespace adhoc_communication
