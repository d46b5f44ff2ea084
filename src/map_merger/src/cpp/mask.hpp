// Masks of cells, 64 to a word, so that what concerns many cells at once is cheap.
#pragma once

#include <cstdint>
#include <vector>

namespace map_merger {

class Mask {
 public:
  Mask(std::int64_t rows, std::int64_t columns);

  std::int64_t rows() const { return rows_; }
  std::int64_t columns() const { return columns_; }
  std::int64_t words() const { return words_; }  // of a row
  const std::uint64_t* row(std::int64_t row) const { return bits_.data() + row * words_; }
  std::uint64_t* row(std::int64_t row) { return bits_.data() + row * words_; }
  bool at(std::int64_t row, std::int64_t column) const { return this->row(row)[column >> 6] >> (column & 63) & 1; }

  bool any() const;
  // Sets the cells [from, to) of a row; what lies outside is left out.
  void set(std::int64_t row, std::int64_t from, std::int64_t to);

  Mask& operator|=(const Mask& other);
  Mask& operator&=(const Mask& other);
  Mask& remove(const Mask& other);
  Mask operator~() const;

 private:
  std::int64_t rows_, columns_, words_;
  std::vector<std::uint64_t> bits_;  // zero beyond the last column
};

inline Mask operator|(Mask first, const Mask& second) { return first |= second; }
inline Mask operator&(Mask first, const Mask& second) { return first &= second; }
inline Mask without(Mask first, const Mask& second) { return first.remove(second); }

// The mask moved by rows and columns (each -63 to 63); nothing comes in from outside.
Mask moved(const Mask& mask, std::int64_t rows, std::int64_t columns);
// Cells with a set cell at most `radius` rows and columns away.
Mask spread(const Mask& mask, std::int64_t radius);
// Cells with set cells only at most `radius` rows and columns away; what lies outside the mask does not count.
Mask shrunk(const Mask& mask, std::int64_t radius);
// Set cells and the four neighbours of each.
Mask crossed(const Mask& mask);

// Calls visit(row, column) for each set cell.
template <typename Visit>
void for_each(const Mask& mask, Visit visit) {
  for (std::int64_t row = 0; row < mask.rows(); ++row) {
    for (std::int64_t word = 0; word < mask.words(); ++word) {
      for (std::uint64_t bits = mask.row(row)[word]; bits; bits &= bits - 1)
        visit(row, word * 64 + __builtin_ctzll(bits));
    }
  }
}

}  // namespace map_merger
