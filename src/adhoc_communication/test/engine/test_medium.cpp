// The simulated radio: reach, walls, shadowing, contention, mobility.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "medium/medium.hpp"
#include "payloads.hpp"
#include "random_waypoint.hpp"
#include "simulation/team.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

using Node = Medium::Node;

Frame broadcast(Node sender, std::size_t octets = 1000) {
  Frame frame;
  frame.destination.fill(0xff);
  frame.source = Team::address(sender);
  frame.bytes.assign(octets, static_cast<std::uint8_t>(sender));
  return frame;
}

void add_at(Medium& medium, const std::vector<Position>& positions) {
  for (const Position& position : positions) {
    const Node node = medium.add_node("robot_" + std::to_string(medium.node_count()));
    medium.set_position(node, position.x, position.y);
  }
}

struct Arrival {
  Node from;
  Node to;
  Time at;
};

bool operator==(const Arrival& a, const Arrival& b) { return a.from == b.from && a.to == b.to && a.at == b.at; }

/// Everything that arrives until the air is quiet.
std::vector<Arrival> arrivals(Medium& medium) {
  std::vector<Arrival> all;
  while (const auto next = medium.next_delivery()) {
    for (const auto& delivery : medium.deliveries(*next)) {
      all.push_back({static_cast<Node>(delivery.frame->bytes[0]), delivery.node, *next});
    }
  }
  return all;
}

std::vector<Node> hearers_of(Medium& medium, Node sender, Time now) {
  medium.transmit(sender, broadcast(sender), now);
  std::vector<Node> nodes;
  for (const Arrival& arrival : arrivals(medium)) nodes.push_back(arrival.to);
  return nodes;
}

/// A fixed course of events, condensed into a number.
std::uint64_t fingerprint(const MediumOptions& options) {
  Medium medium(options, 42);
  Random script(7);
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash](std::uint64_t value) { hash = (hash ^ value) * 0x100000001b3u; };
  for (std::size_t i = 0; i < 12; ++i) {
    medium.add_node("robot_" + std::to_string(i), Team::address(i));
    if (i % 4 == 3) continue;
    const double y = script.uniform() * 25;
    medium.set_position(i, script.uniform() * 25, y);
  }
  medium.set_link_loss(0, 1, 0.5);
  medium.set_one_way_loss(2, 5, 1.0);
  medium.set_link_loss(4, 6, 0.0);
  for (int step = 0; step < 2000; ++step) {
    const Time now = step * 60us;
    const Node sender = script.next() % 12;
    Frame frame = broadcast(sender, script.next() % 1500);
    if (script.chance(0.5)) frame.destination = Team::address(script.next() % 12);
    medium.transmit(sender, frame, now);
    if (step % 10 == 0) {
      const Node mover = script.next() % 12;
      const double y = script.uniform() * 25;
      medium.set_position(mover, script.uniform() * 25, y);
    }
    if (step % 97 == 0) {
      const Node node = script.next() % 12;
      medium.set_up(node, script.chance(0.6), now);
    }
    if (step == 1000) {
      medium.set_range(14.0);
      medium.set_loss(0.05);
      medium.set_link_loss(0, 1, std::nullopt);
    }
    for (const Medium::Delivery& delivery : medium.deliveries(now)) {
      add(delivery.node);
      for (const std::uint8_t octet : delivery.frame->bytes) add(octet);
    }
  }
  add(medium.counters().delivered);
  add(medium.counters().lost);
  add(medium.counters().discarded);
  return hash;
}

MediumOptions rough() {
  MediumOptions options;
  options.loss = 0.2;
  options.duplication = 0.1;
  options.reordering = 0.1;
  options.corruption = 0.1;
  return options;
}

TEST(Medium, SameSeedSameCourseOnEveryMachine) {
  MediumOptions options = rough();
  EXPECT_EQ(fingerprint(options), 0x8a7fa31eaf28e85cu);
  options.shared = true;
  EXPECT_EQ(fingerprint(options), 0x168e7bf94ed32109u);
  options.shared = false;
  options.path_loss = PathLoss();
  options.path_loss->p_tx = 0;
  options.shadowing.deviation = 4.0;
  options.contention = true;
  EXPECT_EQ(fingerprint(options), 0x3d751fb6fd789b68u);
}

TEST(Medium, AnotherSeedIsAnotherCourse) {
  const auto course = [](std::uint64_t seed) {
    MediumOptions options;
    options.contention = true;
    options.loss = 0.3;
    Medium medium(options, seed);
    add_at(medium, {{0, 0}, {1, 0}, {2, 0}});
    for (int i = 0; i < 20; ++i) {
      for (Node node = 0; node < 3; ++node) medium.transmit(node, broadcast(node), 0s);
    }
    return arrivals(medium);
  };
  EXPECT_EQ(course(1), course(1));
  EXPECT_FALSE(course(1) == course(2));
}

TEST(Medium, AirTimeFollowsTheBitRate) {
  MediumOptions options;
  options.bit_rate = 1e6;
  options.frame_overhead = 100us;
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {1, 0}});
  medium.transmit(0, broadcast(0, 1000), 5ms);
  medium.transmit(0, broadcast(0, 500), 5ms);
  EXPECT_EQ(arrivals(medium), (std::vector<Arrival>{{0, 1, 5ms + 8100us}, {0, 1, 5ms + 8100us + 4100us}}));
}

/// 0 - 1 - 2 - 3 - 4 - 5, each in reach of the next: 0 and 3 send at once, 1 only after 0, which it hears, and after 3,
/// which its receiver hears.
TEST(Medium, TurnsAreSharedByThoseFarApart) {
  MediumOptions options;
  options.shared = true;
  options.frame_overhead = 0s;
  options.bit_rate = 8e6;
  const auto course = [&](bool reuse) {
    options.spatial_reuse = reuse;
    Medium medium(options, 1);
    for (Node node = 0; node < 6; ++node) {
      medium.add_node("robot_" + std::to_string(node), Team::address(node));
      medium.set_position(node, 8.0 * static_cast<double>(node), 0);
    }
    for (const Node sender : {0, 3, 1, 4}) {
      Frame frame = broadcast(sender, 1000);
      frame.destination = Team::address(sender + 1);
      medium.transmit(sender, frame, 0s);
    }
    return arrivals(medium);
  };
  EXPECT_EQ(course(true), (std::vector<Arrival>{{0, 1, 1ms}, {3, 4, 1ms}, {1, 2, 2ms}, {4, 5, 2ms}}));
  EXPECT_EQ(course(false), (std::vector<Arrival>{{0, 1, 1ms}, {3, 4, 2ms}, {1, 2, 3ms}, {4, 5, 4ms}}));
}

TEST(Medium, FramesAreKeptUntilTheyAreOffTheAir) {
  for (const bool contention : {false, true}) {
    MediumOptions options;
    options.contention = contention;
    Medium medium(options, 1);
    add_at(medium, {{0, 0}, {8, 0}});
    EXPECT_FALSE(medium.keeps_frames(0));
    medium.transmit(0, broadcast(0), 0ms);
    EXPECT_TRUE(medium.keeps_frames(0));
    EXPECT_FALSE(medium.keeps_frames(1));
    arrivals(medium);
    EXPECT_FALSE(medium.keeps_frames(0));
  }
}

TEST(Medium, OptionsThatMakeNoRadioAreRefused) {
  const auto refused = [](auto change) {
    MediumOptions options;
    change(options);
    EXPECT_THROW(Medium(options, 1), std::invalid_argument);
  };
  refused([](MediumOptions& o) { o.shared = o.contention = true; });
  refused([](MediumOptions& o) { o.spatial_reuse = true; });
  refused([](MediumOptions& o) { o.bit_rate = 0.0; });
  refused([](MediumOptions& o) { o.slots = 0; });
  refused([](MediumOptions& o) { o.rates.broadcast = -1.0; });
  refused([](MediumOptions& o) { o.rates.unicast = {{6e6, 0}, {6e6, 1}}; });
  refused([](MediumOptions& o) { o.rates.unicast = {{0, 0}}; });
  refused([](MediumOptions& o) { o.rates.unicast_retries = 1; });
  refused([](MediumOptions& o) { o.rates.unicast_retries = -1; });
  refused([](MediumOptions& o) { o.wall_attenuation = -1.0; });
  refused([](MediumOptions& o) { o.shadowing.deviation = -1.0; });
  refused([](MediumOptions& o) { o.shadowing.distance = 0.0; });
  refused([](MediumOptions& o) { o.path_loss = PathLoss{15, -75, 33, -1}; });
  refused([](MediumOptions& o) { o.walls = {{1, 0, 1}, 2, 0.1, {}}; });
  refused([](MediumOptions& o) { o.walls = {{1, 0}, 2, 0.0, {}}; });
  Medium medium(MediumOptions(), 1);
  add_at(medium, {{0, 0}});
  EXPECT_THROW(medium.set_position(0, 1e300, 0.0), std::invalid_argument);
  EXPECT_THROW(medium.set_position(0, std::nan(""), 0.0), std::invalid_argument);
}

TEST(MediumPathLoss, IsThatOfTheContract) {
  EXPECT_DOUBLE_EQ(received_power(PathLoss(), 1.0), 15.0 - 33.0);
  EXPECT_DOUBLE_EQ(received_power(PathLoss(), 10.0), 15.0 - 33.0 - 40.0);
  EXPECT_NEAR(distance_of_power(PathLoss(), -75.0), 26.6, 0.05);
  EXPECT_NEAR(distance_of_power({1, -75, 33, 4}, -75.0), 11.9, 0.05);
  EXPECT_NEAR(received_power(PathLoss(), distance_of_power(PathLoss(), -61.5)), -61.5, 1e-9);
}

TEST(MediumPathLoss, DecidesWhoHears) {
  MediumOptions options;
  options.path_loss = PathLoss();
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {26.5, 0}, {26.7, 0}, {0, 0}});
  EXPECT_EQ(hearers_of(medium, 0, 0s), (std::vector<Node>{1, 3}));
  EXPECT_TRUE(medium.in_range(1, 0));
  EXPECT_FALSE(medium.in_range(2, 0));
}

TEST(MediumPathLoss, EveryParameterMovesTheRange) {
  for (double PathLoss::*weaker : {&PathLoss::p_thres, &PathLoss::n_model, &PathLoss::l_0_model}) {
    MediumOptions options;
    options.path_loss = PathLoss();
    (*options.path_loss).*weaker += 1.0;
    Medium medium(options, 1);
    add_at(medium, {{0, 0}, {26.4, 0}});
    EXPECT_FALSE(medium.in_range(0, 1));
  }
}

/// Whoever hears must be whom in_range() names, wherever all go.
void expect_hearers_in_range(const MediumOptions& options, double width) {
  Medium medium(options, 5);
  Random random(3);
  for (Node node = 0; node < 60; ++node) medium.add_node("robot_" + std::to_string(node));
  for (int step = 0; step < 200; ++step) {
    for (int i = 0; i < 3; ++i) {
      const Node node = random.next() % 50;  // ten never get a position
      const double x = (random.uniform() - 0.5) * width;
      medium.set_position(node, x, (random.uniform() - 0.5) * width);
    }
    if (step == 100) medium.set_range(2 * options.range);
    const Node sender = random.next() % 60;
    std::vector<Node> expected;
    for (Node node = 0; node < 60; ++node) {
      if (node != sender && medium.in_range(sender, node)) expected.push_back(node);
    }
    ASSERT_EQ(hearers_of(medium, sender, step * 1s), expected) << "step " << step;
  }
}

Walls room() {
  Walls walls;
  walls.width = 100;
  walls.resolution = 0.5;
  walls.origin = {-25.0, -25.0};
  walls.cells.assign(100 * 100, 0);
  for (std::size_t i = 0; i < 100; ++i) walls.cells[i * 100 + 50] = walls.cells[50 * 100 + i] = 1;
  return walls;
}

TEST(MediumReach, HearersAreThoseInRange) {
  MediumOptions options;
  expect_hearers_in_range(options, 60.0);
  options.shadowing.deviation = 6.0;
  expect_hearers_in_range(options, 60.0);
  options.walls = room();
  expect_hearers_in_range(options, 60.0);
  options.path_loss = PathLoss();
  expect_hearers_in_range(options, 120.0);
}

TEST(MediumReach, LinksGoBeforeDistance) {
  MediumOptions options;
  options.path_loss = PathLoss();
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {1000, 0}, {1, 0}});
  medium.set_one_way_loss(0, 1, 0.0);
  medium.set_one_way_loss(0, 2, 1.0);
  EXPECT_EQ(hearers_of(medium, 0, 0s), std::vector<Node>{1});
  EXPECT_EQ(hearers_of(medium, 2, 1s), std::vector<Node>{0});
  medium.set_link_loss(0, 1, std::nullopt);
  medium.set_link_loss(0, 2, std::nullopt);
  EXPECT_EQ(hearers_of(medium, 0, 2s), std::vector<Node>{2});
}

TEST(MediumReach, WithoutChangesNobodyIsForgotten) {
  Medium medium(MediumOptions(), 1);
  add_at(medium, {{0, 0}, {1, 0}});
  EXPECT_EQ(hearers_of(medium, 0, 0s), std::vector<Node>{1});
  medium.set_up(1, false, 1s);
  EXPECT_EQ(hearers_of(medium, 0, 1s), std::vector<Node>{});
  medium.set_up(1, true, 2s);
  EXPECT_EQ(hearers_of(medium, 0, 2s), std::vector<Node>{1});
  add_at(medium, {{2, 0}});
  EXPECT_EQ(hearers_of(medium, 0, 3s), (std::vector<Node>{1, 2}));
  medium.set_loss(1.0);
  EXPECT_EQ(hearers_of(medium, 0, 4s), std::vector<Node>{});
  medium.set_loss(0.0);
  EXPECT_EQ(hearers_of(medium, 0, 5s), (std::vector<Node>{1, 2}));
  medium.set_range(1.5);
  EXPECT_EQ(hearers_of(medium, 0, 6s), std::vector<Node>{1});
}

/// Drawn like a map: the last row is the lowest, '#' is a wall. Cells of 1 m from the origin.
Walls drawn(const std::vector<std::string>& rows) {
  Walls walls;
  walls.resolution = 1.0;
  walls.width = rows.at(0).size();
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char cell : *row) walls.cells.push_back(cell == '#');
  }
  return walls;
}

TEST(MediumWalls, AreCountedOnceHoweverThick) {
  const Walls walls = drawn({".#..###.#.",  //
                             ".#..###.#."});
  EXPECT_EQ(walls_between(walls, {0.5, 0.5}, {0.9, 1.5}), 0);
  EXPECT_EQ(walls_between(walls, {0.5, 0.5}, {2.5, 0.5}), 1);
  EXPECT_EQ(walls_between(walls, {0.5, 0.5}, {7.5, 1.5}), 2);
  EXPECT_EQ(walls_between(walls, {0.5, 0.5}, {9.5, 1.5}), 3);
  EXPECT_EQ(walls_between(walls, {5.5, 0.5}, {5.5, 0.5}), 1);  // within a wall
}

TEST(MediumWalls, OutsideTheRasterThereAreNone) {
  const Walls walls = drawn({"...",  //
                             ".#.",  //
                             "..."});
  EXPECT_EQ(walls_between(walls, {-100.0, 1.5}, {100.0, 1.5}), 1);
  EXPECT_EQ(walls_between(walls, {1.5, -1e9}, {1.5, 1e9}), 1);
  EXPECT_EQ(walls_between(walls, {-100.0, 3.5}, {100.0, 3.5}), 0);
  EXPECT_EQ(walls_between(walls, {-5.0, 0.0}, {0.0, -5.0}), 0);
  EXPECT_EQ(walls_between(walls, {50.0, 50.0}, {60.0, 70.0}), 0);
}

TEST(MediumWalls, OriginAndResolutionPlaceThem) {
  Walls walls = drawn({".#."});
  walls.origin = {10.0, 20.0};
  walls.resolution = 0.1;
  EXPECT_EQ(walls_between(walls, {10.0, 20.05}, {10.3, 20.05}), 1);
  EXPECT_EQ(walls_between(walls, {10.0, 20.15}, {10.3, 20.15}), 0);
  EXPECT_EQ(walls_between(walls, {10.0, 20.05}, {10.09, 20.05}), 0);
}

Walls scattered(Random& random) {
  Walls walls;
  walls.width = 30;
  walls.resolution = 1.0;
  for (int i = 0; i < 30 * 30; ++i) walls.cells.push_back(random.chance(0.2));
  return walls;
}

TEST(MediumWalls, AreTheSameBothWaysThroughCornersOfCells) {
  Random random(11);
  const Walls walls = scattered(random);
  const auto corner = [&random] {
    const auto x = static_cast<double>(random.next() % 30);
    return Position{x, static_cast<double>(random.next() % 30)};
  };
  for (int i = 0; i < 1000; ++i) {
    const Position a = corner(), b = corner();
    ASSERT_EQ(walls_between(walls, a, b), walls_between(walls, b, a)) << i;
  }
}

TEST(MediumWalls, AreTheSameBothWaysAndAsSampled) {
  Random random(11);
  const Walls walls = scattered(random);
  const auto place = [&random] {
    const double x = random.uniform() * 40 - 5;
    return Position{x, random.uniform() * 40 - 5};
  };
  int different = 0;
  for (int i = 0; i < 1000; ++i) {
    const Position a = place(), b = place();
    const int count = walls_between(walls, a, b);
    ASSERT_EQ(count, walls_between(walls, b, a));
    int sampled = 0;
    bool inside = false;
    for (int step = 0; step <= 20'000; ++step) {
      const double share = step / 20'000.0;
      const double x = a.x + share * (b.x - a.x), y = a.y + share * (b.y - a.y);
      const bool occupied =
          walls.occupied(static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y)));
      sampled += occupied && !inside;
      inside = occupied;
    }
    different += count != sampled;
  }
  EXPECT_LE(different, 15);  // the samples step over corners that the line just touches
}

TEST(MediumWalls, EachWeakensTheFrame) {
  MediumOptions options;
  options.path_loss = PathLoss();
  options.wall_attenuation = 10.0;  // 26.6 m become 15.0 m, then 8.4 m
  options.walls = drawn({".....#.#.........................."});
  Medium medium(options, 1);
  add_at(medium, {{0.5, 0.5}, {6.5, 0.5}, {8.8, 0.5}, {9.0, 0.5}, {0.5, 20.0}});
  EXPECT_EQ(hearers_of(medium, 0, 0s), (std::vector<Node>{1, 2, 4}));
  options.path_loss.reset();
  options.range = 26.6;
  Medium by_range(options, 1);
  add_at(by_range, {{0.5, 0.5}, {6.5, 0.5}, {8.8, 0.5}, {9.0, 0.5}, {0.5, 20.0}});
  EXPECT_EQ(hearers_of(by_range, 0, 0s), (std::vector<Node>{1, 2, 4}));
}

struct Spread {
  double mean;
  double deviation;
};

Spread spread(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double value : values) sum += value, squares += value * value;
  const double mean = sum / static_cast<double>(values.size());
  return {mean, std::sqrt(squares / static_cast<double>(values.size()) - mean * mean)};
}

TEST(MediumShadowing, IsLogNormalWithTheGivenDeviation) {
  const Shadowing shadowing({6.0, 5.0}, 3);
  Random random(1);
  std::vector<double> values;
  for (int i = 0; i < 20'000; ++i) {
    const Position here{random.uniform() * 10'000, i * 10.0};
    const Position there{random.uniform() * 10'000, i * 10.0};
    const double value = shadowing.between(shadowing.at(here), shadowing.at(there));
    EXPECT_LE(std::abs(value), 18.0);
    values.push_back(value);
  }
  EXPECT_NEAR(spread(values).mean, 0.0, 0.15);
  EXPECT_NEAR(spread(values).deviation, 6.0, 0.15);
  const auto within = std::count_if(values.begin(), values.end(), [](double value) { return std::abs(value) < 6.0; });
  EXPECT_NEAR(static_cast<double>(within) / 20'000, 0.683, 0.01);
}

TEST(MediumShadowing, ChangesWithDistance) {
  const Shadowing shadowing({1.0, 5.0}, 3);
  const auto change_over = [&shadowing](double metres) {
    std::vector<double> changes;
    Random random(1);
    for (int i = 0; i < 5'000; ++i) {
      const Position here{random.uniform() * 10'000, random.uniform() * 10'000};
      changes.push_back(shadowing.at({here.x + metres, here.y}) - shadowing.at(here));
    }
    return spread(changes).deviation;
  };
  EXPECT_LT(change_over(0.5), 0.2);
  EXPECT_NEAR(change_over(50.0), std::sqrt(2.0), 0.05);
  EXPECT_LT(change_over(0.5), change_over(2.0));
  EXPECT_LT(change_over(2.0), change_over(5.0));
}

TEST(MediumShadowing, IsTheSameBothWaysAndFollowsTheSeed) {
  MediumOptions options;
  options.path_loss = PathLoss();
  options.shadowing.deviation = 8.0;
  std::vector<Position> places;
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const double x = random.uniform() * 80;
    places.push_back({x, random.uniform() * 80});
  }
  Medium medium(options, 1), same(options, 1), other(options, 2);
  for (Medium* each : {&medium, &same, &other}) add_at(*each, places);
  int differences = 0, surprises = 0;
  for (Node a = 0; a < 40; ++a) {
    for (Node b = 0; b < a; ++b) {
      EXPECT_EQ(medium.in_range(a, b), medium.in_range(b, a));
      EXPECT_EQ(medium.in_range(a, b), same.in_range(a, b));
      differences += medium.in_range(a, b) != other.in_range(a, b);
      surprises += medium.in_range(a, b) != (distance_between(places[a], places[b]) < 26.6);
    }
  }
  EXPECT_GT(differences, 20);
  EXPECT_GT(surprises, 20);
}

MediumOptions contended() {
  MediumOptions options;
  options.contention = true;
  return options;
}

constexpr Time kAirTime = 160us + 50us;  // of 1000 octets at 50 Mbit/s

TEST(MediumContention, ANodeDefersToAFrameItHears) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Medium medium(contended(), seed);
    add_at(medium, {{0, 0}, {1, 0}, {2, 0}});
    medium.transmit(0, broadcast(0), 0s);
    medium.deliveries(144us);  // the longest back-off has passed: the frame is on the air
    medium.transmit(1, broadcast(1), 144us);
    const auto all = arrivals(medium);
    ASSERT_EQ(all.size(), 4u);
    EXPECT_EQ(all[0].from, 0u);
    EXPECT_EQ(all[2].from, 1u);
    EXPECT_GE(all[2].at, all[0].at + kAirTime);
    EXPECT_LE(all[2].at, all[0].at + kAirTime + 15 * 9us);
  }
}

TEST(MediumContention, HiddenTerminalsDestroyEachOthersFrames) {
  Medium medium(contended(), 1);
  add_at(medium, {{0, 0}, {8, 0}, {16, 0}});  // 0 and 2 do not hear each other, 1 hears both
  medium.transmit(0, broadcast(0), 0s);
  medium.transmit(2, broadcast(2), 0s);
  EXPECT_TRUE(arrivals(medium).empty());
  EXPECT_EQ(medium.counters().collided, 2u);
  EXPECT_EQ(medium.counters(0).collided, 1u);
  medium.transmit(0, broadcast(0), 1s);
  EXPECT_EQ(arrivals(medium).size(), 1u);
  medium.transmit(2, broadcast(2), 2s);
  EXPECT_EQ(arrivals(medium).size(), 1u);
}

TEST(MediumContention, TheLateFrameOfAHiddenTerminalIsEnough) {
  MediumOptions options = contended();
  options.slots = 1;
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {8, 0}, {16, 0}});
  medium.transmit(0, broadcast(0), 0s);
  medium.deliveries(0s);
  medium.transmit(2, broadcast(2), kAirTime - 1ns);
  EXPECT_TRUE(arrivals(medium).empty());
  medium.transmit(0, broadcast(0), 1s);
  medium.deliveries(1s);
  medium.transmit(2, broadcast(2), 1s + kAirTime);
  EXPECT_EQ(arrivals(medium).size(), 2u);
}

TEST(MediumContention, TheStrongerFrameSurvivesByTheCaptureThreshold) {
  // 4 m against 8 m at exponent 4: 12.04 dB.
  for (const auto& [capture, survivors] : {std::pair(12.0, std::vector<Node>{0}), {12.1, {}}}) {
    MediumOptions options = contended();
    options.capture = capture;
    Medium medium(options, 1);
    add_at(medium, {{0, 0}, {4, 0}, {12, 0}});
    medium.transmit(0, broadcast(0), 0s);
    medium.transmit(2, broadcast(2), 0s);
    std::vector<Node> senders;
    for (const Arrival& arrival : arrivals(medium)) senders.push_back(arrival.from);
    EXPECT_EQ(senders, survivors) << capture;
  }
}

TEST(MediumContention, ANodeThatSendsDoesNotHear) {
  MediumOptions options = contended();
  options.slots = 1;         // both start at once, so neither senses the other
  options.capture = -100.0;  // and every frame survives every other
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {1, 0}, {2, 0}});
  medium.transmit(0, broadcast(0), 0s);
  medium.transmit(1, broadcast(1, 100), 0s);
  const auto all = arrivals(medium);
  ASSERT_EQ(all.size(), 2u);
  for (const Arrival& arrival : all) EXPECT_EQ(arrival.to, 2u);
  EXPECT_EQ(medium.counters().unheard, 2u);
}

TEST(MediumContention, EqualBackOffsCollideAsOftenAsChanceSays) {
  MediumOptions options = contended();
  options.slots = 4;
  Medium medium(options, 1);
  add_at(medium, {{-1, 0}, {0, 0}, {1, 0}});
  int collisions = 0;
  for (int i = 0; i < 2000; ++i) {
    medium.transmit(0, broadcast(0), i * 1s);
    medium.transmit(2, broadcast(2), i * 1s);
    collisions += arrivals(medium).empty();
  }
  EXPECT_NEAR(collisions / 2000.0, 0.25, 0.03);
}

TEST(MediumContention, ContendersShareTheChannel) {
  Medium medium(contended(), 1);
  add_at(medium, {{0, 0}, {1, 0}, {2, 0}, {1, 1}});
  for (int i = 0; i < 900; ++i) {
    for (Node node = 0; node < 3; ++node) medium.transmit(node, broadcast(node), 0s);
  }
  std::array<int, 3> received{};
  Time end{0};
  while (const auto next = medium.next_delivery()) {
    if (*next > 500ms) break;
    for (const auto& delivery : medium.deliveries(*next)) {
      received[delivery.frame->bytes[0]] += delivery.node == 3;
      end = *next;
    }
  }
  const int sum = received[0] + received[1] + received[2];
  for (const int share : received) EXPECT_NEAR(static_cast<double>(share) / sum, 1.0 / 3.0, 0.03);
  EXPECT_GT(sum * kAirTime, end * 6 / 10);  // most of the time the air carries something whole
  EXPECT_LT(sum * kAirTime, end);
}

TEST(MediumContention, FarAwayNodesSendAtOnce) {
  Medium medium(contended(), 1);
  add_at(medium, {{0, 0}, {1, 0}, {100, 0}, {101, 0}});
  for (int i = 0; i < 100; ++i) {
    for (const Node node : {0, 2}) medium.transmit(node, broadcast(node), 0s);
  }
  const auto all = arrivals(medium);
  EXPECT_EQ(all.size(), 200u);
  EXPECT_LT(all.back().at, 100 * (kAirTime + 15 * 9us));
}

TEST(MediumContention, AFullQueueDiscards) {
  MediumOptions options = contended();
  options.queue_limit = 3;
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {1, 0}});
  for (int i = 0; i < 5; ++i) medium.transmit(0, broadcast(0), 0s);
  EXPECT_EQ(arrivals(medium).size(), 3u);
  EXPECT_EQ(medium.counters().discarded, 2u);
}

TEST(MediumContention, ACrashEndsTheFrameAndClearsTheQueue) {
  MediumOptions options = contended();
  options.slots = 1;
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {1, 0}, {2, 0}});
  for (int i = 0; i < 5; ++i) medium.transmit(0, broadcast(0), 0s);
  medium.deliveries(100us);  // the first is on the air
  medium.set_up(0, false, 100us);
  medium.transmit(1, broadcast(1), 101us);  // the air is free again
  EXPECT_EQ(arrivals(medium), (std::vector<Arrival>{{1, 2, 101us + kAirTime}}));
  medium.set_up(0, true, 1s);
  medium.transmit(0, broadcast(0), 1s);
  EXPECT_EQ(arrivals(medium), (std::vector<Arrival>{{0, 1, 1s + kAirTime}, {0, 2, 1s + kAirTime}}));
}

TEST(MediumContention, ARebootWhileTheOldFrameWouldStillBeOnTheAir) {
  MediumOptions options = contended();
  options.slots = 1;
  Medium medium(options, 1);
  add_at(medium, {{0, 0}, {1, 0}});
  medium.transmit(0, broadcast(0), 0s);
  medium.transmit(0, broadcast(0), 0s);
  medium.deliveries(10us);
  medium.set_up(0, false, 10us);
  medium.set_up(0, true, 20us);
  medium.transmit(0, broadcast(0), 20us);
  EXPECT_EQ(arrivals(medium), (std::vector<Arrival>{{0, 1, 20us + kAirTime}}));
}

TEST(MediumContention, RobotsDeliverOverSeveralHops) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    MediumOptions options = contended();
    options.loss = 0.05;
    Team team(options, seed);
    team.add_line(4);
    team.run_for(2s);
    const Bytes payload = noise(100'000, seed);
    const SendId id = team.send(0, "robot_3", payload);
    ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s)) << "seed " << seed;
    EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
    ASSERT_EQ(team.received(3).size(), 1u);
    EXPECT_EQ(team.received(3)[0].packet.payload, payload);
    EXPECT_GT(team.medium().counters().collided, 0u);
  }
}

TEST(RandomWaypoint, StaysInsideAndWithinItsSpeed) {
  WaypointOptions options;
  options.width = 30.0;
  options.height = 20.0;
  RandomWaypoint robot(options, 4);
  Position last = robot.at(0s);
  double farthest = 0.0;
  int resting = 0;
  for (Time now = 100ms; now < 1h; now += 100ms) {
    const Position position = robot.at(now);
    EXPECT_TRUE(position.x >= 0.0 && position.x <= 30.0 && position.y >= 0.0 && position.y <= 20.0);
    EXPECT_LE(distance_between(last, position), 0.1500001);
    farthest = std::max(farthest, distance_between({15.0, 10.0}, position));
    resting += position == last;
    last = position;
  }
  EXPECT_GT(farthest, 14.0);
  EXPECT_GT(resting, 1000);
}

TEST(RandomWaypoint, FollowsItsSeedHoweverOftenItIsAsked) {
  RandomWaypoint often({}, 9), seldom({}, 9), other({}, 10);
  for (Time now = 0s; now < 10min; now += 50ms) often.at(now);
  EXPECT_EQ(often.at(10min), seldom.at(10min));
  EXPECT_FALSE(often.at(10min) == other.at(10min));
}

TEST(RandomWaypoint, CarriesRobotsInAndOutOfReach) {
  Team team;
  WaypointOptions area;
  area.width = area.height = 30.0;
  std::vector<RandomWaypoint> ways;
  for (std::uint64_t robot = 0; robot < 6; ++robot) {
    ways.emplace_back(area, robot + 1);
    team.add({}, ways[robot].at(0s).x, ways[robot].at(0s).y);
  }
  for (Time now = 0s; now < 120s; now += 100ms) {
    for (std::size_t robot = 0; robot < ways.size(); ++robot) {
      const Position position = ways[robot].at(now);
      team.medium().set_position(robot, position.x, position.y);
    }
    team.run_for(100ms);
  }
  int appeared = 0, lost = 0;
  for (std::size_t robot = 0; robot < ways.size(); ++robot) {
    for (const auto& [at, what] : team.presence(robot)) ++(what[0] == '+' ? appeared : lost);
  }
  EXPECT_GT(appeared, 30);
  EXPECT_GT(lost, 5);
}

}  // namespace
}  // namespace adhoc_communication
