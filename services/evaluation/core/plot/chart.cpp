// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/plot/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace rtd::plot {
namespace {

constexpr double kTickTextSize = 11.5;
constexpr double kPixelsPerXTick = 90, kPixelsPerYTick = 45;

double step_for(double span, int wanted) {
  const double raw = span / std::max(1, wanted);
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double multiple : {1.0, 2.0, 5.0}) {
    if (multiple * power >= raw * 0.75) return multiple * power;
  }
  return 10 * power;
}

Range grown_to(const Range& range, double span) {
  const double centre = (range.min + range.max) / 2;
  return {centre - span / 2, centre + span / 2};
}

double step_of(const std::vector<double>& ticks) {
  return ticks.size() > 1 ? ticks[1] - ticks[0] : 1;
}

}  // namespace

Range range_of(const std::vector<double>& values) {
  Range range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    range.min = std::min(range.min, v);
    range.max = std::max(range.max, v);
  }
  if (range.min > range.max) return {0, 1};
  const double smallest = std::max(1e-9, 1e-9 * std::max(std::abs(range.min), std::abs(range.max)));
  return range.span() < smallest ? grown_to(range, std::max(smallest, 1e-3)) : range;
}

Range range_from_zero(const std::vector<double>& values) {
  double highest = 0;
  for (const double v : values) {
    if (std::isfinite(v)) highest = std::max(highest, v);
  }
  return {0, highest > 0 ? highest * 1.06 : 1};
}

std::vector<double> nice_ticks(const Range& range, int wanted) {
  std::vector<double> ticks;
  if (!(range.span() > 0) || !std::isfinite(range.span())) return ticks;
  const double step = step_for(range.span(), wanted);
  const double first = std::ceil(range.min / step - 1e-9);
  for (int i = 0; i <= 2 * wanted + 2; ++i) {
    const double tick = (first + i) * step;
    if (tick > range.max + 1e-9 * step) break;
    ticks.push_back(tick == 0 ? 0.0 : tick);
  }
  return ticks;
}

std::string tick_label(double tick, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  return fmt::format("{:.{}f}", tick, decimals);
}

Chart::Chart(Svg& svg, const Area& area, const Range& x, const Range& y) : svg_(svg), area_(area), x_(x), y_(y) {}

Chart Chart::equal_aspect(Svg& svg, const Area& area, const Range& x, const Range& y) {
  const double units_per_px = std::max(x.span() / area.width, y.span() / area.height);
  return Chart(svg, area, grown_to(x, units_per_px * area.width), grown_to(y, units_per_px * area.height));
}

Point Chart::at(double x, double y) const {
  return {area_.x + (x - x_.min) / x_.span() * area_.width, area_.y + (y_.max - y) / y_.span() * area_.height};
}

void Chart::draw_axes(const AxisLabels& labels) {
  const double left = area_.x, right = area_.x + area_.width, top = area_.y, bottom = area_.y + area_.height;
  const std::vector<double> x_ticks = nice_ticks(x_, std::max(2, static_cast<int>(area_.width / kPixelsPerXTick)));
  for (const double tick : x_ticks) {
    const double px = at(tick, 0).x;
    svg_.line({px, top}, {px, bottom}, {palette::kGrid, 1});
    svg_.text({px, bottom + 16}, tick_label(tick, step_of(x_ticks)), {palette::kMuted, kTickTextSize, Anchor::kMiddle});
  }
  const std::vector<double> y_ticks = nice_ticks(y_, std::max(2, static_cast<int>(area_.height / kPixelsPerYTick)));
  for (const double tick : y_ticks) {
    const double py = at(0, tick).y;
    svg_.line({left, py}, {right, py}, {palette::kGrid, 1});
    svg_.text({left - 7, py + 4}, tick_label(tick, step_of(y_ticks)), {palette::kMuted, kTickTextSize, Anchor::kEnd});
  }
  svg_.line({left, bottom}, {right, bottom}, {palette::kFrame, 1});
  svg_.line({left, top}, {left, bottom}, {palette::kFrame, 1});
  svg_.text({(left + right) / 2, bottom + 35}, labels.x, {palette::kInk, 12, Anchor::kMiddle});
  svg_.text({left - 44, (top + bottom) / 2}, labels.y, {palette::kInk, 12, Anchor::kMiddle, false, -90});
}

void Chart::curve(const std::vector<double>& x, const std::vector<double>& y, const Stroke& stroke, double max_gap_x) {
  std::vector<Point> run;
  const auto finish = [&] {
    if (run.size() > 1) svg_.polyline(run, stroke);
    if (run.size() == 1) svg_.dots(run, stroke.width + 1, stroke.colour, stroke.opacity);
    run.clear();
  };
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    const bool gap = i > 0 && x[i] - x[i - 1] > max_gap_x;
    if (gap || !std::isfinite(y[i])) finish();
    if (std::isfinite(y[i])) run.push_back(at(x[i], y[i]));
  }
  finish();
}

void Chart::level(double y, const std::string& label, const Stroke& stroke) {
  if (!std::isfinite(y) || y < y_.min || y > y_.max) return;
  const double right = area_.x + area_.width, y_px = at(0, y).y;
  svg_.line({area_.x, y_px}, {right, y_px}, stroke);
  svg_.text({right + 6, y_px + 4}, label, {stroke.colour, kTickTextSize, Anchor::kStart, true});
}

void draw_legend(Svg& svg, Point at, const std::vector<LegendEntry>& entries) {
  for (const LegendEntry& entry : entries) {
    if (entry.dot) {
      svg.circle({at.x + 9, at.y - 4}, 4, entry.colour);
    } else {
      svg.line({at.x, at.y - 4}, {at.x + 18, at.y - 4}, {entry.colour, 3});
    }
    svg.text({at.x + 24, at.y}, entry.text, {palette::kInk, 12});
    at.x += 24 + 6.6 * static_cast<double>(entry.text.size()) + 22;
  }
}

void draw_error_scale(Svg& svg, const Area& area, const ErrorScale& scale) {
  constexpr int kSlices = 48;
  for (int i = 0; i < kSlices; ++i) {
    const double fraction = (i + 0.5) / kSlices;
    svg.rect({area.x, area.y + area.height * (1 - (i + 1.0) / kSlices), area.width, area.height / kSlices + 0.6},
             error_colour(fraction));
  }
  const std::vector<double> ticks = nice_ticks({0, scale.max}, 5);
  for (const double tick : ticks) {
    const double py = area.y + area.height * (1 - tick / scale.max);
    svg.line({area.x + area.width, py}, {area.x + area.width + 4, py}, {palette::kMuted, 1});
    svg.text({area.x + area.width + 8, py + 4}, tick_label(tick, step_of(ticks)), {palette::kMuted, kTickTextSize});
  }
  if (scale.open_ended) {
    svg.text({area.x + area.width + 8, area.y + 4}, "more", {palette::kMuted, kTickTextSize, Anchor::kStart, true});
  }
  svg.text({area.x - 2, area.y - 10}, scale.title, {palette::kInk, 12});
}

}  // namespace rtd::plot
