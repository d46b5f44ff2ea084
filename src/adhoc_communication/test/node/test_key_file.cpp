#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "node/key_file.hpp"

namespace adhoc_communication {
namespace {

class KeyFile : public ::testing::Test {
 protected:
  KeyFile() : path_("/tmp/test_key_file_" + std::to_string(getpid())) {}
  ~KeyFile() override { std::remove(path_.c_str()); }

  void write(const std::string& text, mode_t mode = 0600) {
    std::ofstream(path_) << text;
    chmod(path_.c_str(), mode);
  }
  /// The sentence with which the file is refused; empty if it is taken.
  std::string refusal() {
    try {
      read_key_file(path_);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  }

  const std::string path_;
  const std::string key_ = std::string(62, '0') + "aF";
};

TEST_F(KeyFile, HoldsKeysInOrder) {
  write("# secret\n\n" + key_ + "\n" + std::string(64, '1') + " \n");
  const std::vector<TeamKey> keys = read_key_file(path_);
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[0].back(), 0xaf);
  EXPECT_EQ(keys[1].front(), 0x11);
}

TEST_F(KeyFile, OthersMustNotReadIt) {
  write(key_, 0640);
  EXPECT_NE(refusal().find("chmod 600"), std::string::npos) << refusal();
}

TEST_F(KeyFile, FaultsNameTheFileAndTheLine) {
  EXPECT_NE(refusal().find("team_key create"), std::string::npos) << refusal();
  write(key_ + "\nnot a key\n");
  EXPECT_NE(refusal().find("line 2"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find(path_), std::string::npos) << refusal();
  write("# nothing\n");
  EXPECT_NE(refusal().find("holds no key"), std::string::npos) << refusal();
  write(key_ + "\n" + key_ + "\n" + key_ + "\n" + key_ + "\n" + key_ + "\n");
  EXPECT_NE(refusal().find("more than 4"), std::string::npos) << refusal();
}

TEST_F(KeyFile, AChangeIsSeenOnce) {
  write(key_);
  FileWatch watch(path_);
  EXPECT_FALSE(watch.changed());
  write(key_ + "\n" + key_);
  EXPECT_TRUE(watch.changed());
  EXPECT_FALSE(watch.changed());
  std::remove(path_.c_str());
  EXPECT_TRUE(watch.changed());
}

}  // namespace
}  // namespace adhoc_communication
