// When it tells something that a neighbour is silent.
#include <gtest/gtest.h>

#include "transport/silence_odds.hpp"

namespace adhoc_communication::transport {
namespace {

int needed(double loss) {
  SilenceOdds odds;
  odds.heard(loss);
  int unanswered = 0;
  for (; !odds.tells(); ++unanswered) odds.unanswered();
  return unanswered;
}

TEST(SilenceOdds, SilenceTellsByItselfWhereNothingWasLostBefore) { EXPECT_EQ(needed(0.0), 0); }

TEST(SilenceOdds, TheMoreIsLostTheMoreItTakes) {
  EXPECT_EQ(needed(0.1), 2);
  EXPECT_EQ(needed(0.5), 8);
  EXPECT_EQ(needed(0.8), 26);
  EXPECT_EQ(needed(1.0), needed(0.8)) << "or a dead link would be held on to";
}

TEST(SilenceOdds, WhateverIsHeardBeginsAnew) {
  SilenceOdds odds;
  odds.heard(0.1);
  for (int i = 0; i < 5; ++i) odds.unanswered();
  EXPECT_TRUE(odds.tells());
  odds.heard(0.1);
  EXPECT_FALSE(odds.tells());
}

}  // namespace
}  // namespace adhoc_communication::transport
