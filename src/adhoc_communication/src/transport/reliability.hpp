// Whether frames to a neighbour are as good as never lost: the radio repeats them by itself, or the channel is clean.
#pragma once

namespace adhoc_communication::transport {

/// Remembers some hundred frames, so that chance does not look like it.
class Reliability {
 public:
  static constexpr double kGain = 1.0 / 128.0;
  static constexpr double kBegins = 0.02;  ///< share of the frames that is lost
  static constexpr double kEnds = 0.05;
  static constexpr double kBefore = 0.1;  ///< until anything is known

  void count(bool lost) {
    loss_ += kGain * ((lost ? 1.0 : 0.0) - loss_);
    reliable_ = loss_ < (reliable_ ? kEnds : kBegins);
  }
  bool reliable() const { return reliable_; }

 private:
  double loss_ = kBefore;
  bool reliable_ = false;
};

}  // namespace adhoc_communication::transport
