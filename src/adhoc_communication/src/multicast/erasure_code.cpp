#include "multicast/erasure_code.hpp"

#include <isa-l/erasure_code.h>

#include <stdexcept>

namespace adhoc_communication::multicast {
namespace {

/// Row `symbol` and column `frame` of the Cauchy matrix: all square parts of it can be inverted, because rows and
/// columns have different numbers.
std::uint8_t coefficient(int symbol, int frame) { return gf_inv(static_cast<unsigned char>(symbol ^ frame)); }

/// rows x sources coefficients applied to the sources.
std::vector<Bytes> multiply(std::vector<std::uint8_t> matrix, std::size_t rows,
                            const std::vector<const std::uint8_t*>& sources, std::size_t length) {
  std::vector<Bytes> results(rows, Bytes(length));
  if (sources.empty()) return results;
  std::vector<std::uint8_t> tables(32 * rows * sources.size());
  const int count = static_cast<int>(sources.size());
  ec_init_tables(count, static_cast<int>(rows), matrix.data(), tables.data());
  std::vector<unsigned char*> inputs;
  for (const std::uint8_t* source : sources) inputs.push_back(const_cast<unsigned char*>(source));  // only read
  std::vector<unsigned char*> outputs;
  for (Bytes& result : results) outputs.push_back(result.data());
  ec_encode_data(static_cast<int>(length), count, static_cast<int>(rows), tables.data(), inputs.data(), outputs.data());
  return results;
}

void add(Bytes& sum, const std::uint8_t* octets) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] ^= octets[i];
}

}  // namespace

Bytes parity(const std::vector<const std::uint8_t*>& frames, std::size_t length, int symbol) {
  std::vector<std::uint8_t> row;
  for (std::size_t frame = 0; frame < frames.size(); ++frame)
    row.push_back(coefficient(symbol, static_cast<int>(frame)));
  return std::move(multiply(std::move(row), 1, frames, length).front());
}

std::vector<Bytes> recover(const std::vector<const std::uint8_t*>& frames, std::size_t length,
                           const std::vector<ParitySymbol>& parities) {
  std::vector<int> missing;
  std::vector<int> known;
  std::vector<const std::uint8_t*> known_octets;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    if (frames[frame] == nullptr) {
      missing.push_back(static_cast<int>(frame));
    } else {
      known.push_back(static_cast<int>(frame));
      known_octets.push_back(frames[frame]);
    }
  }
  const std::size_t size = missing.size();
  if (parities.size() != size) throw std::logic_error("recover() needs one parity symbol for each missing frame");
  // What the known frames contribute is taken out of the parity symbols; a small square system is left.
  std::vector<std::uint8_t> of_known;
  std::vector<std::uint8_t> of_missing;
  for (const ParitySymbol& parity : parities) {
    for (const int frame : known) of_known.push_back(coefficient(parity.symbol, frame));
    for (const int frame : missing) of_missing.push_back(coefficient(parity.symbol, frame));
  }
  std::vector<Bytes> remainders = multiply(of_known, size, known_octets, length);
  std::vector<const std::uint8_t*> right_sides;
  for (std::size_t i = 0; i < size; ++i) {
    add(remainders[i], parities[i].octets);
    right_sides.push_back(remainders[i].data());
  }
  std::vector<std::uint8_t> inverse(size * size);
  if (gf_invert_matrix(of_missing.data(), inverse.data(), static_cast<int>(size)) != 0) {
    throw std::logic_error("two parity symbols of a block are the same");
  }
  return multiply(inverse, size, right_sides, length);
}

}  // namespace adhoc_communication::multicast
