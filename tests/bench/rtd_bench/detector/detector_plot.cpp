// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "services/evaluation/core/plot/chart.hpp"
#include "tests/bench/rtd_bench/detector/detector_bench.hpp"

namespace rtd::bench {
namespace {

using namespace plot;

/// Bars to the right, a group for each batch size.
struct BarLayout {
  static constexpr double kWidth = 900, kLeft = 150, kRight = 230, kTop = 70, kBar = 24, kGroupGap = 32, kBottom = 50;
  Range ms;
  double bottom = 0;

  double at(double value_ms) const { return kLeft + value_ms / ms.max * (kWidth - kLeft - kRight); }
};

bool begins_group(const std::vector<DetectorResult>& cases, std::size_t i) {
  return i == 0 || cases[i].what.batch != cases[i - 1].what.batch;
}

BarLayout layout_of(const std::vector<DetectorResult>& cases) {
  std::vector<double> all_ms;
  double bottom = BarLayout::kTop;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    all_ms.push_back(std::max(cases[i].ms_per_image(), cases[i].cpu_ms_per_image));
    bottom += BarLayout::kBar + (begins_group(cases, i) ? BarLayout::kGroupGap : 0);
  }
  return {range_from_zero(all_ms), bottom};
}

const char* engine_colour(const std::string& engine) {
  static constexpr std::array kColours = {std::pair{"cpu", palette::kBlue}, std::pair{"opencl", palette::kAmber},
                                          std::pair{"torch", palette::kPurple}};
  for (const auto& [name, colour] : kColours)
    if (engine.starts_with(name)) return colour;
  return palette::kGreen;
}

void draw_ticks(Svg& svg, const BarLayout& layout) {
  const std::vector<double> ticks = nice_ticks(layout.ms, 8);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : 1;
  for (const double tick : ticks) {
    const double x = layout.at(tick);
    svg.line({x, BarLayout::kTop}, {x, layout.bottom}, {palette::kGrid, 1});
    svg.text({x, layout.bottom + 18}, tick_label(tick, step), {.anchor = Anchor::kMiddle});
  }
  svg.text({layout.at(layout.ms.max / 2), layout.bottom + 38},
           "time of one image [ms], median; line: CPU time, all threads", {.anchor = Anchor::kMiddle});
}

void draw_bar(Svg& svg, const BarLayout& layout, const DetectorResult& result, double y) {
  const double middle = y + BarLayout::kBar / 2;
  svg.text({BarLayout::kLeft - 12, middle + 4}, result.what.engine, {.colour = palette::kInk, .anchor = Anchor::kEnd});
  if (!result.failure.empty()) {
    svg.text({BarLayout::kLeft + 8, middle + 4}, "not measured here", {.size = 11});
    return;
  }
  const double end = layout.at(result.ms_per_image()), cpu = layout.at(result.cpu_ms_per_image);
  svg.rect({BarLayout::kLeft, y + 4, end - BarLayout::kLeft, BarLayout::kBar - 8}, engine_colour(result.what.engine), 1,
           2);
  svg.line({cpu, y + 1}, {cpu, y + BarLayout::kBar - 1}, {palette::kInk, 2});
  svg.text({BarLayout::kWidth - BarLayout::kRight + 14, middle + 4},
           fmt::format("{:.1f} ms, {:.1f}/s, CPU {:.1f} ms", result.ms_per_image(), result.images_per_s(),
                       result.cpu_ms_per_image),
           {.size = 11});
}

}  // namespace

std::string detector_svg(const DetectorComparison& comparison) {
  const BarLayout layout = layout_of(comparison.cases);
  const double height = layout.bottom + BarLayout::kBottom;
  Svg svg(BarLayout::kWidth, height, "Time of one image by engine and batch size");
  svg.rect({0, 0, BarLayout::kWidth, height}, "#ffffff");
  svg.text({24, 30}, "Detector engines", {.colour = palette::kInk, .size = 18, .bold = true});
  svg.text({24, 52}, fmt::format("{}, {}x{}", comparison.model, comparison.input.width_px, comparison.input.height_px));
  draw_ticks(svg, layout);
  double y = BarLayout::kTop;
  for (std::size_t i = 0; i < comparison.cases.size(); ++i) {
    if (begins_group(comparison.cases, i)) {
      svg.text({24, y + 22}, fmt::format("batch {}", comparison.cases[i].what.batch),
               {.colour = palette::kInk, .size = 13, .bold = true});
      y += BarLayout::kGroupGap;
    }
    draw_bar(svg, layout, comparison.cases[i], y);
    y += BarLayout::kBar;
  }
  return svg.document();
}

}  // namespace rtd::bench
