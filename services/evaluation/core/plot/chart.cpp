// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/plot/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace rtd::plot {
namespace {

constexpr const char* kFonts =
    "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue','DejaVu Sans',Arial,sans-serif";

bool is_finite(Point p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

/// Up to one decimal, no trailing zero: keeps files small.
std::string number(double value) {
  const double rounded = std::round(value * 10) / 10;
  return fmt::format("{:g}", rounded == 0 ? 0.0 : rounded);
}

std::string coordinates(const std::vector<Point>& points) {
  std::string text;
  for (const Point& p : points) {
    if (is_finite(p)) text += (text.empty() ? "" : " ") + number(p.x) + "," + number(p.y);
  }
  return text;
}

std::string attributes(const Stroke& stroke) {
  std::string text = fmt::format("stroke=\"{}\" stroke-width=\"{:g}\"", stroke.colour, stroke.width);
  if (!stroke.dashes.empty()) text += " stroke-dasharray=\"" + stroke.dashes + "\"";
  if (stroke.opacity < 1) text += fmt::format(" stroke-opacity=\"{:g}\"", stroke.opacity);
  return text;
}

constexpr std::array<const char*, 3> kAnchorNames{"start", "middle", "end"};  // by Anchor

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

std::string escape_markup(const std::string& text) {
  constexpr std::string_view kSpecial = "&<>\"'";
  constexpr std::array<const char*, kSpecial.size()> kEscaped{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
  std::string safe;
  for (const char c : text) {
    if (const std::size_t special = kSpecial.find(c); special != std::string_view::npos) {
      safe += kEscaped[special];
    } else {
      safe += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return safe;
}

Svg::Svg(double width, double height, const std::string& label) : width_(width), height_(height), label_(label) {}

void Svg::line(Point from, Point to, const Stroke& stroke) {
  if (!is_finite(from) || !is_finite(to)) return;
  body_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n", number(from.x), number(from.y),
                       number(to.x), number(to.y), attributes(stroke));
}

void Svg::polyline(const std::vector<Point>& points, const Stroke& stroke) {
  body_ +=
      fmt::format("<polyline fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" {} points=\"{}\"/>\n",
                  attributes(stroke), coordinates(points));
}

void Svg::rect(const Area& area, const std::string& fill, double opacity, double radius) {
  if (!is_finite({area.x, area.y}) || !is_finite({area.width, area.height})) return;
  body_ += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{:g}\" fill=\"{}\" fill-opacity=\"{:g}\"/>\n",
      number(area.x), number(area.y), number(std::max(0.0, area.width)), number(std::max(0.0, area.height)), radius,
      fill, opacity);
}

void Svg::circle(Point centre, double radius, const std::string& fill, const Stroke& outline) {
  if (!is_finite(centre)) return;
  body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" {}/>\n", number(centre.x), number(centre.y),
                       number(radius), fill, attributes(outline));
}

void Svg::dots(const std::vector<Point>& centres, double diameter, const std::string& colour, double opacity) {
  std::string path;
  for (const Point& p : centres) {
    if (is_finite(p)) path += "M" + number(p.x) + " " + number(p.y) + "h0";  // a round cap without a line is a dot
  }
  if (path.empty()) return;
  body_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke-linecap=\"round\" {}/>\n", path,
                       attributes({colour, diameter, "", opacity}));
}

void Svg::text(Point at, const std::string& content, const TextStyle& style) {
  if (!is_finite(at)) return;
  body_ += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\" font-size=\"{:g}\" text-anchor=\"{}\"", number(at.x),
                       number(at.y), style.colour, style.size, kAnchorNames.at(static_cast<std::size_t>(style.anchor)));
  if (style.bold) body_ += " font-weight=\"600\"";
  if (style.rotation_deg != 0) {
    body_ += fmt::format(" transform=\"rotate({:g} {} {})\"", style.rotation_deg, number(at.x), number(at.y));
  }
  body_ += ">" + escape_markup(content) + "</text>\n";
}

std::string Svg::document() const {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" "
      "height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" role=\"img\" aria-label=\"{2}\" font-family=\"{3}\">\n"
      "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n{4}</svg>\n",
      width_, height_, escape_markup(label_), kFonts, body_);
}

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

}  // namespace rtd::plot
