// Whether the radio repeats frames to one robot by itself, as Wi-Fi does.
//
// Then the loss that is left of them tells nothing of what they cost, and is no measure to set beside the loss of
// beacons, which nobody repeats. Links have to be compared by one kind of loss: as long as nothing is concluded, by the
// greater one, which is that of beacons where the radio repeats, and the one that was measured sooner where it does
// not.
#pragma once

#include <algorithm>
#include <optional>

namespace adhoc_communication::routing {

class LinkLayer {
 public:
  static constexpr double kEnough = 16.0;  ///< sum of the losses of beacons until anything is concluded
  static constexpr double kRemembered = 32.0;
  static constexpr double kHidden = 0.25;  ///< less of the loss is left: it repeats
  static constexpr double kShown = 0.5;    ///< more of it is left: it does not

  /// Losses of a link, 0..1, measured at the same time: of beacons, and of frames to that robot.
  void compare(double of_beacons, double of_unicasts) {
    beacons_ += of_beacons;
    unicasts_ += of_unicasts;
    if (beacons_ > kRemembered) {
      unicasts_ *= kRemembered / beacons_;
      beacons_ = kRemembered;
    }
    if (beacons_ < kEnough) return;
    if (unicasts_ < kHidden * beacons_) repeats_ = true;
    if (unicasts_ > kShown * beacons_) repeats_ = false;
  }
  /// What a frame to a robot costs, by both losses of the link as far as they are known.
  double loss(double of_beacons, std::optional<double> of_unicasts) const {
    if (!of_unicasts || repeats_ == true) return of_beacons;
    return repeats_ == false ? *of_unicasts : std::max(of_beacons, *of_unicasts);
  }
  /// Nothing until it is known.
  std::optional<bool> repeats() const { return repeats_; }

 private:
  double beacons_ = 0.0;
  double unicasts_ = 0.0;
  std::optional<bool> repeats_;
};

}  // namespace adhoc_communication::routing
