// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/evaluation/core/plot/chart.hpp"
#include "tests/bench/rtd_bench/percentile.hpp"
#include "tests/bench/rtd_bench/transport/transport_bench.hpp"

namespace rtd::bench {
namespace {

using namespace plot;

constexpr double kWidth = 900, kLeft = 190, kRight = 120, kTop = 84, kRow = 26, kGroupGap = 34, kBottom = 52;

const char* colour_of(const std::string& vendor) {
  return vendor == "fastdds" ? palette::kBlue : palette::kAmber;
}

std::string microseconds(double us) {
  return us < 1000 ? fmt::format("{:.{}f} µs", us, us < 10 ? 1 : 0)
                   : fmt::format("{:.{}f} ms", us / 1000, us < 10'000 ? 1 : 0);
}

/// Powers of ten from left to right.
struct LogAxis {
  double low = 0, high = 4;  ///< exponents

  double at(double us) const {
    const double part = (std::log10(std::max(us, 1e-3)) - low) / (high - low);
    return kLeft + std::clamp(part, 0.0, 1.0) * (kWidth - kLeft - kRight);
  }
};

LogAxis axis_of(const std::vector<TransportResult>& results) {
  double least = 1e9, most = 1;
  for (const TransportResult& result : results) {
    if (result.failure.empty()) {
      least =
          std::min({least, percentile(result.subscriber.latency_us, 50), percentile(result.publisher.memcpy_us, 50)});
      most = std::max(most, percentile(result.subscriber.latency_us, 99));
    }
  }
  return {std::floor(std::log10(std::max(least, 0.1))), std::ceil(std::log10(most * 1.2))};
}

void draw_grid(Svg& svg, const LogAxis& axis, double bottom) {
  for (double exponent = axis.low; exponent <= axis.high; ++exponent) {
    const double decade = std::pow(10, exponent);
    for (int digit = 2; digit < 10 && exponent < axis.high; ++digit) {
      const double x = axis.at(digit * decade);
      svg.line({x, kTop - 10}, {x, bottom}, {palette::kGrid, 0.6, "", 0.7});
    }
    const double x = axis.at(decade);
    svg.line({x, kTop - 10}, {x, bottom}, {palette::kFrame, 1});
    svg.text({x, bottom + 18}, microseconds(decade), {.anchor = Anchor::kMiddle});
  }
  svg.text({(kLeft + kWidth - kRight) / 2, bottom + 38},
           "from write() to a copy in another process, dot p50, bar to p99", {.anchor = Anchor::kMiddle});
}

void draw_case(Svg& svg, const LogAxis& axis, const TransportResult& result, double y) {
  const std::string name =
      (result.what.vendor == "fastdds" ? "Fast DDS, " : "Cyclone DDS, ") + std::string(to_string(result.what.path));
  svg.text({kLeft - 14, y + 4}, name, {.colour = palette::kInk, .anchor = Anchor::kEnd});
  if (!result.failure.empty()) {
    svg.text({kLeft + 8, y + 4}, "not available here", {.size = 11});
    return;
  }
  const double p50 = percentile(result.subscriber.latency_us, 50), p99 = percentile(result.subscriber.latency_us, 99);
  const std::string colour = colour_of(result.what.vendor);
  const double memcpy_x = axis.at(percentile(result.publisher.memcpy_us, 50));
  svg.line({memcpy_x, y - 9}, {memcpy_x, y + 9}, {palette::kGreen, 2.5});
  svg.line({axis.at(p50), y}, {axis.at(p99), y}, {colour, 5, "", 0.3});
  svg.line({axis.at(p99), y - 5}, {axis.at(p99), y + 5}, {colour, 1.5});
  svg.circle({axis.at(p50), y}, 5.5, colour);
  svg.text({kWidth - kRight + 14, y + 4}, microseconds(p50) + fmt::format(", {:.0f}/s", result.publisher.rate_hz),
           {.size = 11});
}

double height_of(const std::vector<TransportResult>& results) {
  double height = kTop + kBottom;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const bool first = i == 0 || results[i].what.payload != results[i - 1].what.payload;
    height += kRow + (first ? kGroupGap : 0);
  }
  return height;
}

}  // namespace

std::string transport_svg(const std::vector<TransportResult>& results) {
  const double height = height_of(results), bottom = height - kBottom;
  Svg svg(kWidth, height, "Latency of every message on every path beside a plain memcpy");
  const LogAxis axis = axis_of(results);
  svg.rect({0, 0, kWidth, height}, "#ffffff");
  svg.text({24, 30}, "Transport on one host", {.colour = palette::kInk, .size = 18, .bold = true});
  draw_legend(
      svg, {24, 54},
      {{"Fast DDS", palette::kBlue, true}, {"Cyclone DDS", palette::kAmber, true}, {"memcpy", palette::kGreen}});
  svg.text({kWidth - kRight + 14, 54}, "p50, max rate", {.size = 11});
  draw_grid(svg, axis, bottom);
  double y = kTop;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (i == 0 || results[i].what.payload != results[i - 1].what.payload) {
      svg.text({24, y + 20}, title(results[i].what.payload), {.colour = palette::kInk, .size = 13, .bold = true});
      y += kGroupGap;
    }
    draw_case(svg, axis, results[i], y + kRow / 2);
    y += kRow;
  }
  return svg.document();
}

}  // namespace rtd::bench
