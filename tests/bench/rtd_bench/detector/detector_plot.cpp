// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "services/evaluation/core/plot/chart.hpp"
#include "tests/bench/rtd_bench/detector/detector_bench.hpp"

namespace rtd::bench {
namespace {

using namespace plot;

/// Bars to the right, in groups.
struct BarLayout {
  static constexpr double kWidth = 900, kLeft = 150, kRight = 230, kBar = 24, kGroupGap = 32, kBottom = 50;
  Range values;
  double top = 70, bottom = 70;

  double at(double value) const { return kLeft + value / values.max * (kWidth - kLeft - kRight); }
};

bool begins_group(const std::vector<DetectorResult>& cases, std::size_t i) {
  return i == 0 || cases[i].what.batch != cases[i - 1].what.batch;
}
bool begins_group(const std::vector<FleetResult>& cases, std::size_t i) {
  return i == 0 || cases[i].robots != cases[i - 1].robots;
}

template <class Result>
double height_of(const std::vector<Result>& cases) {
  double height = 0;
  for (std::size_t i = 0; i < cases.size(); ++i)
    height += BarLayout::kBar + (begins_group(cases, i) ? BarLayout::kGroupGap : 0);
  return height;
}

BarLayout layout_of(const std::vector<DetectorResult>& cases) {
  std::vector<double> all_ms;
  for (const DetectorResult& result : cases) all_ms.push_back(std::max(result.ms_per_image(), result.cpu_ms_per_image));
  BarLayout layout{{0, all_ms.empty() ? 1 : std::ranges::max(all_ms) * 1.06}};
  layout.bottom = layout.top + height_of(cases);
  return layout;
}

const char* engine_colour(const std::string& engine) {
  return engine == "cpu" ? palette::kBlue : palette::kGreen;
}

void draw_ticks(Svg& svg, const BarLayout& layout, const std::string& axis) {
  const std::vector<double> ticks = nice_ticks(layout.values, 8);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : 1;
  for (const double tick : ticks) {
    const double x = layout.at(tick);
    svg.line({x, layout.top}, {x, layout.bottom}, {palette::kGrid, 1});
    svg.text({x, layout.bottom + 18}, tick_label(tick, step), {.anchor = Anchor::kMiddle});
  }
  svg.text({layout.at(layout.values.max / 2), layout.bottom + 38}, axis, {.anchor = Anchor::kMiddle});
}

struct Bar {
  std::string label, figures, failure;
  const char* colour;
  double length = 0;
};

void draw_bar(Svg& svg, const BarLayout& layout, const Bar& bar, double y) {
  const double middle = y + BarLayout::kBar / 2;
  svg.text({BarLayout::kLeft - 12, middle + 4}, bar.label, {.colour = palette::kInk, .anchor = Anchor::kEnd});
  if (!bar.failure.empty()) {
    svg.text({BarLayout::kLeft + 8, middle + 4}, "not measured here", {.size = 11});
    return;
  }
  const double end = layout.at(bar.length);
  svg.rect({BarLayout::kLeft, y + 4, end - BarLayout::kLeft, BarLayout::kBar - 8}, bar.colour, 1, 2);
  svg.text({BarLayout::kWidth - BarLayout::kRight + 14, middle + 4}, bar.figures, {.size = 11});
}

/// All bars, `title` above each group.
template <class Result>
void draw_groups(Svg& svg, const BarLayout& layout, const std::vector<Result>& cases, const auto& title,
                 const auto& draw) {
  double y = layout.top;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (begins_group(cases, i)) {
      svg.text({24, y + 22}, title(cases[i]), {.colour = palette::kInk, .size = 13, .bold = true});
      y += BarLayout::kGroupGap;
    }
    draw(cases[i], y);
    y += BarLayout::kBar;
  }
}

void draw_engines(Svg& svg, const BarLayout& layout, const std::vector<DetectorResult>& cases) {
  draw_ticks(svg, layout, "time of one image [ms], median; line: CPU time, all threads");
  const auto title = [](const DetectorResult& result) { return fmt::format("batch {}", result.what.batch); };
  draw_groups(svg, layout, cases, title, [&](const DetectorResult& result, double y) {
    const double ms = result.ms_per_image(), cpu = layout.at(result.cpu_ms_per_image);
    const std::string figures =
        fmt::format("{:.1f} ms, {:.1f}/s, CPU {:.1f} ms", ms, result.images_per_s(), result.cpu_ms_per_image);
    draw_bar(
        svg, layout,
        {detector::engine_label(result.what.engine), figures, result.failure, engine_colour(result.what.engine), ms},
        y);
    if (result.failure.empty()) svg.line({cpu, y + 1}, {cpu, y + BarLayout::kBar - 1}, {palette::kInk, 2});
  });
}

/// By the number of robots.
void draw_robots(Svg& svg, const BarLayout& layout, const std::vector<FleetResult>& cases, double rate_hz) {
  draw_ticks(svg, layout, fmt::format("answers a second for each robot, of {:g} images", rate_hz));
  const auto title = [](const FleetResult& result) {
    return fmt::format("{} robot{}", result.robots, result.robots == 1 ? "" : "s");
  };
  draw_groups(svg, layout, cases, title, [&](const FleetResult& result, double y) {
    draw_bar(svg, layout,
             {fmt::format("{}, batch {}", detector::engine_label(result.engine), result.batch),
              fmt::format("{:.1f} Hz, p99 {:.0f} ms, CPU {:.0f} %", result.mean_hz, result.latency_p99_ms,
                          result.cpu_percent),
              result.failure, engine_colour(result.engine), result.mean_hz},
             y);
  });
}

}  // namespace

std::string detector_svg(const DetectorComparison& comparison) {
  const BarLayout engines = layout_of(comparison.cases);
  std::vector<FleetResult> fleet = comparison.fleet;
  std::ranges::stable_sort(fleet, {}, &FleetResult::robots);
  BarLayout robots{Range{0, std::max(comparison.load.rate_hz, 1e-3)}, engines.bottom + BarLayout::kBottom + 20};
  robots.bottom = robots.top + height_of(fleet);
  const double height = (fleet.empty() ? engines.bottom : robots.bottom) + BarLayout::kBottom;
  Svg svg(BarLayout::kWidth, height, "Time of one image by engine and batch size");
  svg.rect({0, 0, BarLayout::kWidth, height}, "#ffffff");
  svg.text({24, 30}, "Detector engines", {.colour = palette::kInk, .size = 18, .bold = true});
  svg.text({24, 52}, fmt::format("{}, {}x{}", comparison.model, comparison.input.width_px, comparison.input.height_px));
  draw_engines(svg, engines, comparison.cases);
  if (!fleet.empty()) draw_robots(svg, robots, fleet, comparison.load.rate_hz);
  return svg.document();
}

}  // namespace rtd::bench
