#include "mask.hpp"

#include <algorithm>

namespace map_merger {
namespace {

Mask down(const Mask& mask, std::int64_t rows) {
  Mask result(mask.rows(), mask.columns());
  const std::int64_t first = std::max<std::int64_t>(0, rows), last = std::min(mask.rows(), mask.rows() + rows);
  if (first < last) std::copy(mask.row(first - rows), mask.row(last - rows), result.row(first));
  return result;
}

// By 1 to 63 columns to higher ones.
Mask right(const Mask& mask, int columns) {
  Mask result(mask.rows(), mask.columns());
  const std::uint64_t valid = ~std::uint64_t{0} >> (-mask.columns() & 63);
  for (std::int64_t row = 0; row < mask.rows(); ++row) {
    const std::uint64_t* from = mask.row(row);
    std::uint64_t *to = result.row(row), before = 0;
    for (std::int64_t word = 0; word < mask.words(); ++word) {
      to[word] = from[word] << columns | before >> (64 - columns);
      before = from[word];
    }
    if (mask.words()) to[mask.words() - 1] &= valid;
  }
  return result;
}

Mask left(const Mask& mask, int columns) {
  Mask result(mask.rows(), mask.columns());
  for (std::int64_t row = 0; row < mask.rows(); ++row) {
    const std::uint64_t* from = mask.row(row);
    std::uint64_t *to = result.row(row), after = 0;
    for (std::int64_t word = mask.words() - 1; word >= 0; --word) {
      to[word] = from[word] >> columns | after << (64 - columns);
      after = from[word];
    }
  }
  return result;
}

// The word with each set bit, also those of the words beside it, spread to `radius` places on both sides.
std::uint64_t smeared(std::uint64_t word, std::uint64_t before, std::uint64_t after, int radius) {
  std::uint64_t result = word;
  for (int step = 1; step <= radius; ++step) {
    result |= word << step | before >> (64 - step) | word >> step | after << (64 - step);
  }
  return result;
}

void spread_row(const std::uint64_t* from, std::uint64_t* to, std::int64_t words, std::int64_t columns, int radius) {
  for (std::int64_t word = 0; word < words; ++word) {
    const std::uint64_t before = word > 0 ? from[word - 1] : 0, after = word + 1 < words ? from[word + 1] : 0;
    to[word] = smeared(from[word], before, after, radius);
  }
  if (words) to[words - 1] &= ~std::uint64_t{0} >> (-columns & 63);
}

}  // namespace

Mask::Mask(std::int64_t rows, std::int64_t columns)
    : rows_(rows), columns_(columns), words_((columns + 63) / 64), bits_(static_cast<std::size_t>(rows * words_)) {}

bool Mask::any() const {
  return std::any_of(bits_.begin(), bits_.end(), [](std::uint64_t word) { return word != 0; });
}

void Mask::set(std::int64_t row, std::int64_t from, std::int64_t to) {
  if (row < 0 || row >= rows_) return;
  from = std::max<std::int64_t>(from, 0), to = std::min(to, columns_);
  while (from < to) {
    const std::int64_t count = std::min<std::int64_t>(to - from, 64 - (from & 63));
    this->row(row)[from >> 6] |= ~std::uint64_t{0} >> (64 - count) << (from & 63);
    from += count;
  }
}

Mask& Mask::operator|=(const Mask& other) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] |= other.bits_[i];
  return *this;
}

Mask& Mask::operator&=(const Mask& other) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] &= other.bits_[i];
  return *this;
}

Mask& Mask::remove(const Mask& other) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] &= ~other.bits_[i];
  return *this;
}

Mask Mask::operator~() const {
  Mask result = *this;
  for (std::uint64_t& word : result.bits_) word = ~word;
  const std::uint64_t valid = ~std::uint64_t{0} >> (-columns_ & 63);
  for (std::int64_t row = 0; row < rows_ && words_ > 0; ++row) result.row(row)[words_ - 1] &= valid;
  return result;
}

Mask moved(const Mask& mask, std::int64_t rows, std::int64_t columns) {
  Mask result = rows ? down(mask, rows) : mask;
  if (columns > 0) return right(result, static_cast<int>(columns));
  return columns < 0 ? left(result, static_cast<int>(-columns)) : result;
}

Mask spread(const Mask& mask, std::int64_t radius) {
  Mask across(mask.rows(), mask.columns());
  for (std::int64_t row = 0; row < mask.rows(); ++row)
    spread_row(mask.row(row), across.row(row), mask.words(), mask.columns(), static_cast<int>(radius));
  Mask result = across;
  const std::int64_t words = mask.words();
  for (std::int64_t row = 0; row < mask.rows(); ++row) {
    const std::int64_t first = std::max<std::int64_t>(0, row - radius), last = std::min(mask.rows() - 1, row + radius);
    std::uint64_t* to = result.row(row);
    for (std::int64_t other = first; other <= last; ++other) {
      const std::uint64_t* from = across.row(other);
      for (std::int64_t word = 0; word < words; ++word) to[word] |= from[word];
    }
  }
  return result;
}

Mask shrunk(const Mask& mask, std::int64_t radius) { return ~spread(~mask, radius); }

Mask crossed(const Mask& mask) {
  Mask result = mask;
  for (const int step : {-1, 1}) result |= moved(mask, step, 0) | moved(mask, 0, step);
  return result;
}

}  // namespace map_merger
