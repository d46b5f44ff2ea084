// Which run of each robot lives. Boot ids have no order, so this is decided by who was heard, and by life signs.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "address_map.hpp"
#include "routing/rate_limit.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::routing {

/// What the robot itself says, in a frame that this robot has heard (of a sealed team: from a proven run), counts most:
/// a run heard within kHeardRecently is not displaced by what others tell. Of runs only told of, the newer one counts,
/// until the other one goes on to raise its life sign; such a run is then not displaced without need a second time.
///
/// A frame of another run than the one that is heard may be the first one after a restart, or of somebody else who has
/// or borrows the address. So it is dropped, and makes the run that lives doubtful: this robot sends it a question. If
/// that run acknowledges it, it lives, whoever else transmits with its address. If nothing is heard of it for kUnheard,
/// or it only transmits and acknowledges nothing for kUnanswered, the next run that acknowledges the question is
/// believed; in twice the time, any. Nothing is kept of the others, however many they are. A run whose link works one
/// way only is not asked, and gives way at once when it was silent for kHeardRecently; one that there is no time to ask
/// is given kUnheardUnasked.
///
/// A life sign that others tell grows with time only: by a little more than has passed since the first one, or since
/// the robot itself was last heard to tell one. A greater one counts as the greatest that is possible. One that was
/// told too great in the beginning gives way to signs below it that go on to grow, of the robot itself or, while nobody
/// raises the great one, of others.
///
/// What an ended run has sent can be played back to robots that did not hear it then. But a life sign grows once a
/// second for as long as the run lives, so what is played back is behind by as much as it was delayed.
///
/// At most kMostRobots; the one without news for longest makes room.
class LivingRuns {
 public:
  static constexpr std::size_t kMostRobots = 1024;
  static constexpr std::size_t kMostFormerRuns = 8;  ///< of one robot; mere claims, then the oldest, are forgotten
  static constexpr Time kHeardRecently = std::chrono::seconds(2);
  static constexpr Time kForget = std::chrono::seconds(60);
  static constexpr Time kGone = std::chrono::seconds(5);            ///< nothing heard: the next run is believed at once
  static constexpr Time kUnheard = std::chrono::milliseconds(300);  ///< of a run in doubt
  static constexpr Time kUnanswered = std::chrono::seconds(1);
  static constexpr Time kTrust = std::chrono::seconds(1);  ///< after an answer, until it is doubted anew
  static constexpr Time kAskAgain = std::chrono::milliseconds(150);
  static constexpr Time kContested = std::chrono::seconds(5);  ///< two robots with one address are told of after this
  /// Of a run in doubt that was not asked: three beacons of one at rest.
  static constexpr Time kUnheardUnasked = std::chrono::milliseconds(3200);
  static constexpr std::uint32_t kSecondsThatProveLife = 2;  ///< by which its life sign has to have grown
  /// How far behind the life sign may be of a former run: in its own beacon, and in what others tell.
  static constexpr Time kBeaconDelay = std::chrono::seconds(2);
  static constexpr Time kRumorDelay = std::chrono::seconds(10);

  static constexpr int kMostQuestions = 32;  ///< in a second

  /// `asks`: this robot repeats frames to its neighbours until they are acknowledged.
  explicit LivingRuns(bool asks = true) : asks_(asks) {}

  /// A beacon of the robot itself carries this life sign; to be told before the frame is heard(). Of use to former
  /// runs.
  void beacon(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now);
  /// A frame of the robot itself. False if it is not one of the run that lives, as far as is known. `answers`: it
  /// acknowledges a frame of this robot's.
  bool heard(const MacAddress& robot, wire::BootTag boot, std::uint64_t counter, Time now, bool answers = false);
  /// A beacon of the robot itself, of a run that is not proven: reason enough to ask the one that lives.
  void suspected(const MacAddress& robot, wire::BootTag boot, Time now);
  /// Whether it is in doubt, and to be asked now. `two_way`: its link works in both directions.
  bool wants_answer(const MacAddress& robot, bool two_way, Time now);
  /// Two runs have transmitted with this address for kContested.
  bool contested(const MacAddress& robot, Time now) const;
  /// There may be such robots.
  bool any_contested(Time now) const { return now - last_rival_ < kHeardRecently; }
  /// Somebody says that this run of the robot did something. False if that is not to be believed.
  bool told(const MacAddress& robot, wire::BootTag boot, Time now);
  /// As told(), with a life sign, which is believed if it is greater than the one before. To be given as credible().
  bool told_alive(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now);
  /// The robot itself says so, in a frame that was heard().
  bool said_alive(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now);
  /// What others tell, or the greatest life sign that the run can have.
  std::uint32_t credible(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now) const;
  /// Others tell of a sign below the one believed. True if it takes its place: such signs have grown with time while
  /// the one believed was not raised.
  bool goes_on_below(const MacAddress& robot, wire::BootTag boot, std::uint32_t sign, Time now);

  bool lives(const MacAddress& robot, wire::BootTag boot) const;
  /// The greatest life sign of the run that lives; 0 if none is known.
  std::uint32_t life_sign(const MacAddress& robot) const;
  /// The same of this run; 0 if it does not live.
  std::uint32_t life_sign(const MacAddress& robot, wire::BootTag boot) const;
  /// A frame of the robot itself came within kHeardRecently.
  bool heard_lately(const MacAddress& robot, Time now) const;
  void expire(Time now);
  std::size_t size() const { return robots_.size(); }

 private:
  struct FormerRun {
    wire::BootTag boot = 0;
    std::uint32_t sign = 0;
    Time signed_at{0};          ///< when that sign was told first
    std::uint64_t counter = 0;  ///< greatest one heard
    Time alive_at{0};           ///< when its own frames last showed that they are not recorded
  };
  struct Sign {
    std::uint32_t value = 0;  ///< 0: none
    Time at{0};
  };
  /// Other runs that transmit with the address of one that is heard: no matter which, and how many.
  struct Rival {
    Time since{0};
    Time last = -kHeardRecently;
    std::optional<Time> doubted;  ///< since when the run that lives has not answered
    Time asked = -kAskAgain;
    bool two_way = false;  ///< the link was when the doubt began, or since
    Time trusted_until{0};
  };
  struct Runs {
    wire::BootTag boot = 0;  ///< the one that lives
    std::uint32_t sign = 0;
    Sign measure;                  ///< by which greater ones are credible or not
    bool measured_itself = false;  ///< the robot itself told that one
    Sign below;                    ///< told by others while a greater one was believed, and not raised
    Sign said_below;               ///< by the robot itself while a greater one was believed
    std::uint64_t counter = 0;
    Time heard = -kGone;  ///< itself
    Time signed_at{0};
    Time defended = -kHeardRecently;  ///< its sign was raised, or it displaced a run that had one
    bool reinstated = false;          ///< it was displaced wrongly before
    Time news{0};
    Rival rival;
    std::vector<FormerRun> former;  ///< newest last
  };

  Runs& runs_of(const MacAddress& robot, wire::BootTag boot, Time now);
  void make_room(Time now);
  bool gives_way(Runs& runs, bool to_who_answers, Time now);
  static void doubt(Rival& rival, Time now);
  static bool goes_on(Sign& below, std::uint32_t sign, Time now);
  static void believe(Runs& runs, std::uint32_t sign, Time now);
  static FormerRun* former(Runs& runs, wire::BootTag boot);
  static bool in_step(FormerRun& run, std::uint32_t sign, Time delay, Time now);
  static void forget_one(Runs& runs);
  static void displace(Runs& runs, wire::BootTag boot);

  bool asks_;
  RateLimit questions_{kMostQuestions};
  Time last_rival_ = -kHeardRecently;
  AddressMap<Runs> robots_;
  Time next_expiry_{0};
};

}  // namespace adhoc_communication::routing
