// Walls read from image files, good and bad.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "radio/wall_image.hpp"

namespace adhoc_communication {
namespace {

class WallImage : public ::testing::Test {
 protected:
  WallImage() {
    char path[] = "/tmp/wall_image_XXXXXX";
    close(mkstemp(path));
    path_ = path;
  }
  ~WallImage() override { unlink(path_.c_str()); }

  Walls read(const std::string& octets) const {
    std::ofstream(path_, std::ios::binary) << octets;
    Walls walls;
    read_wall_image(path_, walls);
    return walls;
  }

  std::string complaint(const std::string& octets) const {
    try {
      read(octets);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  std::string path_;
};

TEST_F(WallImage, DarkPixelsAreWallsAndTheLastRowIsTheLowest) {
  const Walls walls =
      read(std::string("P5\n# by hand\n3 2\n# still the header\n255\n") + '\0' + "\xff\xff" + "\xcd\x7f\x80");
  EXPECT_EQ(walls.width, 3u);
  EXPECT_EQ(walls.cells, (std::vector<std::uint8_t>{0, 1, 0, 1, 0, 0}));
}

TEST_F(WallImage, BrightnessIsRelative) {
  EXPECT_EQ(read("P5 2 1 9\n\x04\x05").cells, (std::vector<std::uint8_t>{1, 0}));
}

TEST_F(WallImage, PixelsMayLookLikeBlanks) {
  EXPECT_EQ(read("P5 2 1 255\n\n\xff").cells, (std::vector<std::uint8_t>{1, 0}));
}

TEST_F(WallImage, WhatIsWrongIsNamed) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "is not a binary PGM image"},
      {"\x89PNG\r\n", "is not a binary PGM image"},
      {"P2 1 1 255\n0", "is not a binary PGM image"},
      {"P5", "no width"},
      {"P5 0 1 255\n", "no width"},
      {"P5 -1 1 255\n", "no width"},
      {"P5 1 x 255\n", "no height"},
      {"P5 1 1 65535\n", "no brightest value from 1 to 255"},
      {"P5 99999999999999999999 1 255\n", "no width"},
      {"P5 100000 100000 255\n", "more than 100 million cells"},
      {"P5 2 2 255\nabc", "ends before its last row"},
  };
  for (const auto& [octets, expected] : cases) {
    EXPECT_NE(complaint(octets).find(expected), std::string::npos) << octets << ": " << complaint(octets);
    EXPECT_NE(complaint(octets).find(path_), std::string::npos);
  }
}

TEST_F(WallImage, AbsentFileIsNamed) {
  Walls walls;
  EXPECT_THROW(read_wall_image("/nowhere/walls.pgm", walls), std::invalid_argument);
  EXPECT_THROW(read_wall_image("/tmp", walls), std::invalid_argument);
}

}  // namespace
}  // namespace adhoc_communication
