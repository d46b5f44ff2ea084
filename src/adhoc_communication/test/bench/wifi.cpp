// What other parts measure with one rate for all frames, on Wi-Fi.
#include "wifi.hpp"

#include <algorithm>
#include <cmath>

#include "any_radio.hpp"
#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

constexpr std::size_t kFullFrame = 1500;
// First seeds: how busy a radio is kept was chosen on 1 to 10, what a silent neighbour gets was looked at up to 5300.
constexpr int kFirstGoodput = 101, kFirstKill = 6001;

double rate_at(double distance, const MediumOptions& medium) {
  return unicast_bit_rate(medium.rates.unicast, 40.0 * std::log10(medium.range / distance));
}

/// Bit/s that full frames of a saturated robot carry.
double saturated(double bit_rate, const MediumOptions& medium) {
  return 8.0 * kFullFrame / unicast_time(kFullFrame, bit_rate, medium);
}

/// What that leaves to data when every eighth frame is acknowledged by one on the same channel.
double left_by_acknowledgments(double bit_rate, const MediumOptions& medium) {
  const double frame = unicast_time(kFullFrame, bit_rate, medium);
  return frame / (frame + unicast_time(acknowledgment_octets(), bit_rate, medium) / 8);
}

Row goodput_row(std::size_t hops, double spacing, double loss, int seeds) {
  const MediumOptions medium = wifi(loss);
  const double bit_rate = rate_at(spacing, medium);
  const double capacity = saturated(bit_rate, medium);
  std::vector<double> shares;
  for (int seed = kFirstGoodput; seed < kFirstGoodput + seeds; ++seed) {
    shares.push_back(goodput(hops, spacing, medium, static_cast<std::uint64_t>(seed)) / capacity);
  }
  const double left = left_by_acknowledgments(bit_rate, medium);
  const double bar = hops == 1 ? 0.90 * left : 0.85 * left / static_cast<double>(std::min<std::size_t>(hops, 3));
  const double worst = quantile(shares, 0.0);
  return {format("Wi-Fi: goodput over what full frames carry, %.0f hops at %.0f Mbit/s, loss %.0f %%: worst",
                 static_cast<double>(hops), bit_rate * 1e-6, loss * 100),
          format(">= %.3f", bar),
          worst,
          "1",
          worst >= bar,
          format("median %.3f of %.0f seeds, %.2f Mbit/s", quantile(shares, 0.5), static_cast<double>(shares.size()),
                 quantile(shares, 0.5) * capacity * 1e-6)};
}

}  // namespace

MediumOptions wifi(double loss, double broadcast) {
  MediumOptions medium;
  medium.contention = true;
  medium.loss = loss;
  medium.rates.broadcast = broadcast;
  medium.rates.unicast = ofdm_rates();
  medium.rates.unicast_retries = 7;
  return medium;
}

double distance_at(double bit_rate, const MediumOptions& medium) {
  const std::vector<Rate> rates = ofdm_rates();
  const auto rate = std::find_if(rates.begin(), rates.end(), [&](const Rate& r) { return r.bit_rate >= bit_rate; });
  const double margin = rate->margin + 0.5;
  return medium.range * std::pow(10.0, -margin / 40.0);
}

double frame_time(std::size_t octets, double bit_rate, bool unicast, const MediumOptions& medium, int tries_before) {
  constexpr std::size_t kMostSlots = 1024;
  const auto slots = static_cast<double>(std::min(medium.slots << tries_before, kMostSlots));
  const double answer = unicast ? seconds(medium.rates.acknowledgment) : 0.0;
  return (slots - 1) / 2 * seconds(medium.slot) + seconds(medium.frame_overhead) +
         8.0 * static_cast<double>(octets) / bit_rate + answer;
}

double unicast_time(std::size_t octets, double bit_rate, const MediumOptions& medium) {
  double time = 0;
  for (int lost = 0; lost <= medium.rates.unicast_retries; ++lost) {
    time += std::pow(medium.loss, lost) * frame_time(octets, bit_rate, true, medium, lost);
  }
  return time;
}

void measure_wifi(const Effort& effort, Rows& rows) {
  const int seeds = std::max(10, effort.trials / 2);
  for (const double loss : {0.0, 0.1, 0.3}) {
    rows.add(goodput_row(1, distance_at(54e6, wifi(loss)), loss, seeds));
    for (const std::size_t hops : {1, 2, 3}) rows.add(goodput_row(hops, 8.0, loss, seeds));
  }
  // Half of what two hops of a shared channel carry.
  const double carried = saturated(rate_at(8.0, wifi(0.0)), wifi(0.0)) / 2;
  const Time interval(static_cast<Time::rep>(8e9 * 10'000 / (0.5 * carried)));
  for (const double loss : {0.0, 0.1})
    rows.add(repair(wifi(loss), ", Wi-Fi", interval, kFirstKill, 15 * effort.trials));
  for (const double loss : {0.0, 0.3}) rows.add(first_route(wifi(loss), ", Wi-Fi", effort.trials));
}

}  // namespace adhoc_communication::bench
