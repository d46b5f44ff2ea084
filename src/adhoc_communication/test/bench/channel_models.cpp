#include "channel_models.hpp"

#include <algorithm>
#include <utility>

#include "rows.hpp"
#include "transport/hop_sender.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

const auto kSteady = []() -> Course { return [](Medium&, Time) {}; };

MediumOptions bursts(Time good, Time bad) {
  MediumOptions medium;
  medium.bursts.good = good;
  medium.bursts.bad = bad;
  return medium;
}

MediumOptions delayed(Time fixed, Time jitter = 0ms, bool reorders = false) {
  MediumOptions medium;
  medium.delay = {fixed, jitter, reorders};
  return medium;
}

MediumOptions at_rate(double bit_rate) {
  MediumOptions medium;
  medium.bit_rate = bit_rate;
  return medium;
}

MediumOptions disturbed(Time period, Time duration) {
  MediumOptions medium;
  medium.interference = {period, duration};
  return medium;
}

EngineOptions with_mtu(int mtu) {
  EngineOptions options;
  options.mtu = mtu;
  return options;
}

ChannelModel one_way_loss(const std::string& name, double there, double back) {
  ChannelModel channel{name, {}};
  channel.course = [there, back]() -> Course {
    return [there, back, set = false](Medium& medium, Time) mutable {
      if (std::exchange(set, true)) return;
      for (Medium::Node node = 0; node + 1 < medium.node_count(); ++node) {
        medium.set_one_way_loss(node, node + 1, there);
        medium.set_one_way_loss(node + 1, node, back);
      }
    };
  };
  return channel;
}

/// Slow for the last 1.9 of each 6 seconds.
ChannelModel changing_rate() {
  ChannelModel channel{"54, 1, 54 Mbit/s", at_rate(54e6)};
  channel.course = []() -> Course {
    return [slow = false](Medium& medium, Time now) mutable {
      const bool slow_now = now % 6s >= 4'100ms;
      if (std::exchange(slow, slow_now) != slow_now) medium.set_bit_rate(slow_now ? 1e6 : 54e6);
    };
  };
  return channel;
}

ChannelModel fading(const std::string& name, Time outage) {
  ChannelModel channel{name, {}};
  channel.outage = outage;
  channel.course = [outage]() -> Course {
    return [outage, cut = false](Medium& medium, Time now) mutable {
      const bool cut_now = faded(outage, now);
      if (std::exchange(cut, cut_now) == cut_now) return;
      medium.set_link_loss(0, 1, cut_now ? std::optional(1.0) : std::nullopt);
    };
  };
  return channel;
}

std::size_t octets_of_frame(const EngineOptions& options) {
  return static_cast<std::size_t>(std::min(options.max_frame_size - 14, options.mtu));
}

}  // namespace

/// The first begins shortly after the packet whose time is taken.
bool faded(Time outage, Time now) { return now >= 4s && (now - 4s + kFadePeriod - 100ms) % kFadePeriod < outage; }

std::vector<ChannelModel> channel_models() {
  return {{"clean", {}},
          {"bursts of 20 ms, loss 10 %", bursts(180ms, 20ms)},
          {"bursts of 20 ms, loss 30 %", bursts(47ms, 20ms)},
          {"bursts of 100 ms, loss 20 %", bursts(400ms, 100ms)},
          {"bursts of 500 ms, loss 10 %", bursts(4'500ms, 500ms)},
          {"bursts of 500 ms, loss 30 %", bursts(1'167ms, 500ms)},
          fading("fades of 0.2 s", 200ms),
          fading("fades of 1 s", 1s),
          fading("fades of 3 s", 3s),
          one_way_loss("loss 50 % there, 0 % back", 0.5, 0.0),
          one_way_loss("loss 0 % there, 50 % back", 0.0, 0.5),
          one_way_loss("loss 90 % there, 0 % back", 0.9, 0.0),
          one_way_loss("loss 0 % there, 90 % back", 0.0, 0.9),
          {"delay 5 ms", delayed(5ms)},
          {"delay 50 ms", delayed(50ms)},
          {"delay 300 ms", delayed(300ms)},
          {"jitter to 50 ms, in order", delayed(0ms, 50ms)},
          {"jitter to 50 ms, out of order", delayed(0ms, 50ms, true)},
          {"250 kbit/s", at_rate(250e3)},
          {"1 Mbit/s", at_rate(1e6)},
          changing_rate(),
          {"MTU 400", {}, kSteady, with_mtu(400)},
          {"MTU 576", {}, kSteady, with_mtu(576)},
          {"interference 10 of 20 ms", disturbed(20ms, 10ms)},
          {"jammed 2 of 10 s", disturbed(10s, 2s)}};
}

double ideal_time(const ChannelModel& channel, std::size_t hops, std::size_t octets, std::uint64_t seed, Time begin) {
  MediumOptions options = channel.medium;
  const Time round_trip = 2 * (options.delay.fixed + options.delay.jitter);
  options.delay = {};
  Medium medium(options, seed);
  const Course course = channel.course();
  for (std::size_t node = 0; node <= hops; ++node) {
    medium.add_node("node_" + std::to_string(node), MacAddress{2, 0, 0, 0, 0, static_cast<std::uint8_t>(node)});
    medium.set_position(node, 8.0 * static_cast<double>(node), 0);
  }
  const std::size_t frame_octets = octets_of_frame(channel.engine);
  const std::size_t room = frame_octets - wire::kHeaderSize - wire::kTagSize - wire::kDataHeaderSize;
  std::vector<std::size_t> passed(hops + 1, 0);  // frames that each node has got rid of, or the last one has got
  const std::size_t frames = (octets + room - 1) / room;
  Time now = begin;
  for (Time step = begin; now - begin < 600s;) {
    if (step <= now) {
      course(medium, now);
      step = now + kCourseStep;
    }
    for (std::size_t node = 0; node < hops; ++node) {
      const std::size_t has = node == 0 ? frames : passed[node - 1];
      if (medium.keeps_frames(node) || passed[node] >= has) continue;
      const MacAddress source{2, 0, 0, 0, 0, static_cast<std::uint8_t>(node)};
      const MacAddress destination{2, 0, 0, 0, 0, static_cast<std::uint8_t>(node + 1)};
      medium.transmit(node, {destination, source, Bytes(frame_octets, 0)}, now);
    }
    now = std::min(step, medium.next_delivery().value_or(step));
    for (const Medium::Delivery& delivery : medium.deliveries(now)) ++passed[delivery.node - 1];
    if (passed[hops - 1] >= frames) break;
  }
  const auto windows = static_cast<Time::rep>(frames / transport::HopSender::kSpan);
  return seconds(std::max(now - begin, windows * round_trip) + static_cast<int>(hops) * round_trip);
}

}  // namespace adhoc_communication::bench
