// Nobody who has posted a command waits in vain.
#include <gtest/gtest.h>
#include <poll.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "node/commands.hpp"

namespace adhoc_communication {
namespace {

struct Listed {
  Commands commands;
  std::vector<std::string> log;

  bool post(const std::string& name, bool throws = false) {
    const auto run = [this, name, throws](Time) {
      log.push_back("run " + name);
      if (throws) throw std::runtime_error(name);
    };
    return commands.post({run, [this, name] { log.push_back("fail " + name); }});
  }
  bool has_news() const {
    struct pollfd news = {commands.descriptor(), POLLIN, 0};
    return poll(&news, 1, 0) == 1;
  }
};

TEST(Commands, RunInOrder) {
  Listed listed;
  EXPECT_FALSE(listed.has_news());
  listed.post("a");
  listed.post("b");
  EXPECT_TRUE(listed.has_news());
  listed.commands.run(Time(1));
  EXPECT_FALSE(listed.has_news());
  listed.commands.fail();
  EXPECT_EQ(listed.log, (std::vector<std::string>{"run a", "run b"}));
}

/// Those behind one that threw were dropped, and who had posted them waited for ever.
TEST(Commands, FailWhereOneHasThrown) {
  Listed listed;
  listed.post("a", true);
  listed.post("b");
  EXPECT_THROW(listed.commands.run(Time(1)), std::runtime_error);
  listed.post("c");
  listed.commands.close();
  EXPECT_TRUE(listed.commands.closed());
  EXPECT_FALSE(listed.post("d"));
  listed.commands.fail();
  EXPECT_EQ(listed.log, (std::vector<std::string>{"run a", "fail a", "fail b", "fail c"}));
}

TEST(Commands, FailWhateverOneThrows) {
  Commands commands;
  int failed = 0;
  for (int i = 0; i < 2; ++i) {
    commands.post({[](Time) {},
                   [&] {
                     ++failed;
                     throw 7;
                   }});
  }
  commands.fail();
  EXPECT_EQ(failed, 2);
}

}  // namespace
}  // namespace adhoc_communication
