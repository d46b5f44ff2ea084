// Whether the radio repeats frames to one robot by itself, as Wi-Fi does.
//
// Then the loss that is left of them tells nothing of what they cost, and is no measure to set beside the loss of
// beacons, which nobody repeats. Links have to be compared by one kind of loss.
#pragma once

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
  bool repeats() const { return repeats_; }

 private:
  double beacons_ = 0.0;
  double unicasts_ = 0.0;
  bool repeats_ = false;
};

}  // namespace adhoc_communication::routing
