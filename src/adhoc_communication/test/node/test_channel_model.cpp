// The channel model of simulation_mode against the figures of the contract.
#include <gtest/gtest.h>

#include "link/mac_address.hpp"
#include "node/channel_model.hpp"
#include "propagation/path_loss.hpp"

namespace adhoc_communication {
namespace {

Frame frame_from(const std::string& robot) {
  Frame frame;
  frame.source = address_of_robot(robot);
  frame.destination = kBroadcastAddress;
  return frame;
}

TEST(ChannelModel, RangeIs26Point6MetresWithTheDefaults) {
  EXPECT_TRUE(is_received(ChannelModel(), 26.5));
  EXPECT_FALSE(is_received(ChannelModel(), 26.7));
}

TEST(ChannelModel, RangeIs11Point9MetresAtTransmitPower1) {
  ChannelModel model;
  model.p_tx = 1;
  EXPECT_TRUE(is_received(model, 11.8));
  EXPECT_FALSE(is_received(model, 11.95));
}

TEST(ChannelModel, EveryParameterMovesTheRange) {
  const double edge = 26.6;
  for (int ChannelModel::*weaker : {&ChannelModel::p_thres, &ChannelModel::n_model, &ChannelModel::l_0_model}) {
    ChannelModel model;
    model.*weaker += 1;
    EXPECT_FALSE(is_received(model, edge - 0.2));
  }
  ChannelModel stronger;
  stronger.p_tx += 1;
  EXPECT_TRUE(is_received(stronger, edge + 0.2));
}

TEST(ChannelModel, HasTheDefaultsOfTheSimulatedRadio) {
  EXPECT_EQ(ChannelModel().p_tx, PathLoss().p_tx);
  EXPECT_EQ(ChannelModel().p_thres, PathLoss().p_thres);
  EXPECT_EQ(ChannelModel().l_0_model, PathLoss().l_0_model);
  EXPECT_EQ(ChannelModel().n_model, PathLoss().n_model);
}

TEST(ChannelModel, RobotsInTheSamePlaceHearEachOther) { EXPECT_TRUE(is_received(ChannelModel(), 0.0)); }

TEST(ReceiveFilter, NothingIsReceivedUntilBothPositionsAreKnown) {
  PositionTable positions;
  ReceiveFilter filter("robot_0", {}, ChannelModel(), &positions);
  EXPECT_FALSE(filter.accepts(frame_from("robot_1")));
  positions.set("robot_0", {0.0, 0.0});
  EXPECT_FALSE(filter.accepts(frame_from("robot_1")));
  positions.set("robot_1", {3.0, 4.0});
  EXPECT_TRUE(filter.accepts(frame_from("robot_1")));
  positions.set("robot_1", {30.0, 0.0});
  EXPECT_FALSE(filter.accepts(frame_from("robot_1")));
}

TEST(ReceiveFilter, ListedAddressesAreAWhitelistAlsoWithoutChannelModel) {
  ReceiveFilter filter("bob", {{address_of_robot("robot_1"), "alice"}}, ChannelModel(), nullptr);
  EXPECT_TRUE(filter.accepts(frame_from("robot_1")));
  EXPECT_FALSE(filter.accepts(frame_from("robot_2")));
}

TEST(ReceiveFilter, ListedNameTakesPartInTheChannelModel) {
  PositionTable positions;
  positions.set("robot_0", {0.0, 0.0});
  positions.set("robot_5", {1.0, 0.0});
  const MacAddress own_choice{0x00, 0x11, 0x22, 0x33, 0x44, 0x55};
  ReceiveFilter filter("robot_0", {{own_choice, "robot_5"}}, ChannelModel(), &positions);
  Frame frame;
  frame.source = own_choice;
  EXPECT_TRUE(filter.accepts(frame));
}

TEST(ReceiveFilter, UnnamedSenderIsReportedOnce) {
  PositionTable positions;
  ReceiveFilter filter("robot_0", {}, ChannelModel(), &positions);
  const Frame frame = frame_from("bob");
  EXPECT_FALSE(filter.accepts(frame));
  EXPECT_EQ(filter.next_unnamed_sender(), frame.source);
  EXPECT_FALSE(filter.accepts(frame));
  EXPECT_EQ(filter.next_unnamed_sender(), std::nullopt);
}

TEST(MacAddress, ReadsWhatItWritesWithAnySeparator) {
  const MacAddress address{0x02, 0xab, 0x00, 0xff, 0x10, 0x01};
  EXPECT_EQ(parse_mac_address(to_text(address)), address);
  EXPECT_EQ(parse_mac_address("02-AB-00-FF-10-01"), address);
}

TEST(MacAddress, RefusesWhatIsNoAddressOfANode) {
  for (const char* text : {"", "02", "02:ab:00:ff:10", "02:ab:00:ff:10:0g", "02:ab:00:ff:10:01:", "ff:ff:ff:ff:ff:ff",
                           "01:00:00:00:00:00", "00:00:00:00:00:00", "02:ab:00:ff:10:001"}) {
    EXPECT_THROW(parse_mac_address(text), std::invalid_argument) << text;
  }
}

TEST(MacAddress, OfANumberedRobotTellsItsName) {
  EXPECT_EQ(robot_of_address(address_of_robot("robot_70000")), "robot_70000");
  EXPECT_EQ(robot_of_address(address_of_robot("bob")), std::nullopt);
  EXPECT_NE(address_of_robot("bob"), address_of_robot("marley"));
}

}  // namespace
}  // namespace adhoc_communication
