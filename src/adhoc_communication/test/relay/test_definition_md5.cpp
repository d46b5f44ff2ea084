// The MD5 sums that genmsg writes into message classes, computed from their definitions.
#include <adhoc_communication/ExpFrontier.h>
#include <adhoc_communication/MmMapUpdate.h>
#include <adhoc_communication/NetworkState.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/Twist.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/message_traits.h>
#include <std_msgs/Empty.h>
#include <std_msgs/String.h>

#include "relay/definition_md5.hpp"
#include "relay/message.hpp"

namespace adhoc_communication {
namespace {

template <typename Message>
void expect_its_sum() {
  namespace traits = ros::message_traits;
  EXPECT_EQ(md5_of_definition(traits::datatype<Message>(), traits::definition<Message>()), traits::md5sum<Message>())
      << traits::datatype<Message>();
}

TEST(DefinitionMd5, IsThatOfGenmsg) {
  expect_its_sum<std_msgs::Empty>();
  expect_its_sum<std_msgs::String>();
  expect_its_sum<geometry_msgs::Twist>();
  expect_its_sum<nav_msgs::Odometry>();
  expect_its_sum<diagnostic_msgs::DiagnosticArray>();
  expect_its_sum<NetworkState>();
  expect_its_sum<MmMapUpdate>();
  expect_its_sum<ExpFrontier>();
}

TEST(DefinitionMd5, AnotherFieldIsAnotherSum) {
  const std::string sum = ros::message_traits::md5sum<std_msgs::String>();
  EXPECT_EQ(md5_of_definition("std_msgs/String", "# a comment\n string   data  # another\n"), sum);
  EXPECT_NE(md5_of_definition("std_msgs/String", "string date\n"), sum);
}

/// Without a memory of what is done, this would take 2^31 sums.
TEST(DefinitionMd5, ATypeThatIsUsedTwiceIsSummedOnce) {
  constexpr int kTypes = 31;
  const auto twice = [](int i) { return "T" + std::to_string(i) + " a\nT" + std::to_string(i) + " b\n"; };
  std::string definition = twice(1);
  for (int i = 1; i <= kTypes; ++i) {
    definition +=
        std::string(80, '=') + "\nMSG: a/T" + std::to_string(i) + "\n" + (i < kTypes ? twice(i + 1) : "int8 x\n");
  }
  EXPECT_EQ(md5_of_definition("a/T0", definition), "6f636910d7e72c29bb59c8b8b24065dd");
}

TEST(DefinitionMd5, WhatIsMissingIsNamed) {
  EXPECT_THROW(md5_of_definition("a/B", "C field\n"), PayloadError);
  EXPECT_THROW(md5_of_definition("a/B", "B itself\n"), PayloadError);
}

}  // namespace
}  // namespace adhoc_communication
