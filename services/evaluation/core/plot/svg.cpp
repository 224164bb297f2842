// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/plot/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace rtd::plot {
namespace {

using Rgb = std::array<double, 3>;
constexpr std::array<Rgb, 5> kErrorStops{
    {{35, 80, 160}, {38, 148, 150}, {120, 178, 70}, {232, 155, 40}, {196, 32, 38}}};

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

}  // namespace

std::string error_colour(double fraction) {
  const double t = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 1.0;
  const double position = t * (kErrorStops.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(position), kErrorStops.size() - 2);
  const auto mix = [&](std::size_t channel) {
    return std::lround(
        std::lerp(kErrorStops[below][channel], kErrorStops[below + 1][channel], position - static_cast<double>(below)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

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

std::string Svg::str() const {
  return fmt::format(
      "<svg viewBox=\"0 0 {0:g} {1:g}\" role=\"img\" aria-label=\"{2}\" font-family=\"{3}\">\n{4}</svg>\n", width_,
      height_, escape_markup(label_), kFonts, body_);
}

std::string Svg::document() const {
  const std::string background =
      fmt::format("<rect width=\"{:g}\" height=\"{:g}\" fill=\"#ffffff\"/>\n", width_, height_);
  std::string drawing = str();
  const std::string sized =
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:g}\" height=\"{:g}\" ", width_, height_);
  drawing.replace(0, 5, sized);
  drawing.insert(drawing.find(">\n") + 2, background);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + drawing;
}

}  // namespace rtd::plot
