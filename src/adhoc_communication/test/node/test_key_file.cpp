#include <fcntl.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>

#include "node/key_file.hpp"
#include "security/cipher.hpp"

namespace {

/// Memory in which this stands is counted when it is given back.
std::atomic<const char*> watched_secret{nullptr};
std::atomic<int> secrets_given_back{0};

void give_back(void* memory) {
  const char* secret = watched_secret;
  if (memory != nullptr && secret != nullptr &&
      memmem(memory, malloc_usable_size(memory), secret, strlen(secret)) != nullptr) {
    ++secrets_given_back;
  }
  std::free(memory);
}

}  // namespace

void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void* operator new(std::size_t size) {
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}

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

/// Part of a line; the text comes to the file without passing through memory that could be mistaken for a remnant.
TEST_F(KeyFile, NothingOfTheKeysStaysInMemoryGivenBack) {
  static constexpr char kText[] = "5ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2\n";
  static constexpr char kOctets[] = "\x5e\xc2\xe7\x5e\xc2\xe7\x5e\xc2\xe7\x5e\xc2\xe7";
  const int file = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0600);
  ASSERT_EQ(::write(file, kText, sizeof kText - 1), static_cast<ssize_t>(sizeof kText - 1));
  close(file);
  for (const char* secret : {&kText[8], &kOctets[0]}) {
    const std::string watched(secret, 12);
    watched_secret = watched.c_str();
    std::vector<TeamKey> keys = read_key_file(path_);
    EXPECT_EQ(keys.at(0)[0], 0x5e);
    security::wipe(keys);
    watched_secret = nullptr;
  }
  EXPECT_EQ(secrets_given_back, 0);
  static std::string leak(kText);
  watched_secret = &kText[60];
  std::string(std::move(leak)) += std::string(200, ' ');
  watched_secret = nullptr;
  EXPECT_GT(secrets_given_back, 0) << "what is left behind is seen";
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
