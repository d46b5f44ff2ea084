#include "radio/wall_image.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

namespace adhoc_communication {
namespace {

constexpr std::size_t kMostCells = 100'000'000;
constexpr std::size_t kLongestSide = 100'000;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw std::invalid_argument("wall image '" + path + "' " + why);
}

void skip_comments(std::istream& file) {
  while ((file >> std::ws).peek() == '#') file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
}

std::size_t number(std::istream& file, const std::string& path, const char* what, std::size_t highest) {
  skip_comments(file);
  std::size_t value = 0;
  if (!(file >> value) || value == 0 || value > highest) {
    refuse(path, std::string("has no ") + what + " from 1 to " + std::to_string(highest) + " in its header");
  }
  return value;
}

/// The first row of an image is the uppermost, that of a raster the lowest.
void fill_from_below(Walls& walls, const std::vector<char>& pixels, std::size_t brightest) {
  const std::size_t height = pixels.size() / walls.width;
  walls.cells.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::size_t row = height - 1 - i / walls.width;
    const auto brightness = static_cast<std::uint8_t>(pixels[i]);
    walls.cells[row * walls.width + i % walls.width] = 2u * brightness < brightest;
  }
}

}  // namespace

void read_wall_image(const std::string& path, Walls& walls) {
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path, std::string("cannot be read: ") + std::strerror(errno));
  char magic[2] = {};
  if (!file.read(magic, sizeof magic) || magic[0] != 'P' || magic[1] != '5') {
    refuse(path, "is not a binary PGM image (P5); ImageMagick makes one with \"convert IMAGE -depth 8 walls.pgm\"");
  }
  walls.width = number(file, path, "width", kLongestSide);
  const std::size_t height = number(file, path, "height", kLongestSide);
  const std::size_t brightest = number(file, path, "brightest value", 255);
  if (walls.width * height > kMostCells) refuse(path, "has more than 100 million cells");
  file.get();  // the one blank that ends the header
  std::vector<char> pixels(walls.width * height);
  if (!file.read(pixels.data(), static_cast<std::streamsize>(pixels.size()))) refuse(path, "ends before its last row");
  fill_from_below(walls, pixels, brightest);
}

}  // namespace adhoc_communication
