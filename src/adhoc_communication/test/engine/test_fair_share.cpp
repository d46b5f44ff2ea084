// A relay's own packets beside those of others.
#include <gtest/gtest.h>

#include "host.hpp"
#include "transport/fair_share.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using transport::FairShare;

TEST(FairShare, WhoHasSentLeastGoesFirst) {
  FairShare share;
  EXPECT_EQ(share.order()[0], FairShare::kTransit);
  share.charge(FairShare::kTransit, 1500);
  share.charge(FairShare::kGroups, 100);
  EXPECT_EQ(share.order(), (std::array<FairShare::Kind, 3>{FairShare::kOwn, FairShare::kGroups, FairShare::kTransit}));
}

TEST(FairShare, SilenceEarnsLittle) {
  FairShare share;
  for (int i = 0; i < 1000; ++i) share.charge(FairShare::kTransit, 1500);
  std::size_t ahead = 0;
  while (share.order()[0] != FairShare::kTransit) {
    share.charge(share.order()[0], 1000);
    ahead += 1000;
  }
  EXPECT_LE(ahead, 2 * FairShare::kMostCredit);
}

/// Frames of others went first, so that under constant transit a relay's own packets waited for ever.
TEST(FairShare, ARelaySendsBesideConstantTransit) {
  const auto seconds = [](bool transit) {
    Team team;
    team.add_line(3, without_groups());
    team.run_for(2s);
    const SendId passing = transit ? team.send(0, "robot_2", noise(8'000'000), Priority::kBulk) : 0;
    if (transit) team.run_for(200ms);
    const Time begin = team.now();
    const SendId own = team.send(1, "robot_2", noise(500'000), Priority::kBulk);
    EXPECT_TRUE(team.run_until_done([&] { return team.finished(1, own) != nullptr; }, 20s));
    EXPECT_TRUE(team.finished(1, own) != nullptr && team.finished(1, own)->delivered);
    if (transit) EXPECT_EQ(team.finished(0, passing), nullptr) << "there was no transit";
    return static_cast<double>((team.now() - begin).count()) * 1e-9;
  };
  EXPECT_LE(seconds(true), 2 * 2 * seconds(false));
}

}  // namespace
}  // namespace adhoc_communication
