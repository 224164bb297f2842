// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::plot {

/// Colours, for a white background and distinct for colour-blind readers.
namespace palette {
inline constexpr const char* kInk = "#1c2733";
inline constexpr const char* kMuted = "#64727f";
inline constexpr const char* kGrid = "#e7ebef";
inline constexpr const char* kFrame = "#b9c2cb";
inline constexpr const char* kBlue = "#2367a8";
inline constexpr const char* kGreen = "#2d9c5f";
inline constexpr const char* kAmber = "#dd8a1d";
inline constexpr const char* kTruth = "#9aa5b1";
}  // namespace palette

/// A position on the drawing, px, y down.
struct Point {
  double x = 0, y = 0;
};

/// An area of the drawing, px.
struct Area {
  double x = 0, y = 0, width = 0, height = 0;
};

struct Stroke {
  std::string colour;
  double width = 1;
  std::string dashes = "";  ///< e.g. "4 3"
  double opacity = 1;
};

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  std::string colour = "#64727f";
  double size = 12;
  Anchor anchor = Anchor::kStart;
  bool bold = false;
  double rotation_deg = 0;
};

/// Text made safe for HTML and SVG: & < > " ' escaped, control characters replaced.
std::string escape_markup(const std::string& text);

/// Writes one SVG drawing. Shapes with coordinates that are not finite are left out, so that a bad number cannot break
/// a page.
class Svg {
 public:
  /// label: what the drawing shows, for screen readers.
  Svg(double width, double height, const std::string& label);

  void line(Point from, Point to, const Stroke& stroke);
  void polyline(const std::vector<Point>& points, const Stroke& stroke);
  void rect(const Area& area, const std::string& fill, double opacity = 1, double radius = 0);
  void circle(Point centre, double radius, const std::string& fill, const Stroke& outline = {"none", 0});
  /// Many round dots of one colour in one element.
  void dots(const std::vector<Point>& centres, double diameter, const std::string& colour, double opacity = 1);
  void text(Point at, const std::string& content, const TextStyle& style = {});

  /// The drawing as a complete SVG file.
  std::string document() const;

 private:
  double width_, height_;
  std::string label_, body_;
};

struct Range {
  double min = 0, max = 1;
  double span() const { return max - min; }
};

/// Smallest range of the finite values; {0, 1} when there are none, widened when all are equal.
Range range_of(const std::vector<double>& values);

/// About `wanted` round numbers (1, 2 or 5 times a power of ten apart) inside the range.
std::vector<double> nice_ticks(const Range& range, int wanted);
/// Tick as text with the decimals that its step needs.
std::string tick_label(double tick, double step);

struct AxisLabels {
  std::string x, y;  ///< with unit, e.g. "time [s]"
};

/// A framed area with axes that maps data to the drawing.
class Chart {
 public:
  /// `area` is the plotting area itself; tick labels and axis titles are left of it and below it.
  Chart(Svg& svg, const Area& area, const Range& x, const Range& y);

  /// Both axes get the same metres per pixel; the tighter range grows about its centre.
  static Chart equal_aspect(Svg& svg, const Area& area, const Range& x, const Range& y);

  /// Grid, ticks and labels: call before drawing data.
  void draw_axes(const AxisLabels& labels);

  Point at(double x, double y) const;

  /// Line through the data, interrupted where x jumps by more than max_gap_x.
  void curve(const std::vector<double>& x, const std::vector<double>& y, const Stroke& stroke, double max_gap_x);

 private:
  Svg& svg_;
  Area area_;
  Range x_, y_;
};

struct LegendEntry {
  std::string text;
  std::string colour;
  bool dot = false;  ///< a dot instead of a line
};

/// One row of entries, left-aligned at `at`.
void draw_legend(Svg& svg, Point at, const std::vector<LegendEntry>& entries);

}  // namespace rtd::plot
