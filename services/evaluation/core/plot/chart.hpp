// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/core/plot/svg.hpp"

namespace rtd::plot {

struct Range {
  double min = 0, max = 1;
  double span() const { return max - min; }
};

/// Smallest range of the finite values; {0, 1} when there are none, widened when all are equal.
Range range_of(const std::vector<double>& values);
/// From 0 to a little above the largest finite value: for quantities that are never negative.
Range range_from_zero(const std::vector<double>& values);

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
  /// A horizontal line over the whole width, labelled at its right end outside the frame.
  void level(double y, const std::string& label, const Stroke& stroke);

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

/// The values that a bar of error_colour shows.
struct ErrorScale {
  double max = 1;           ///< value of the last colour
  std::string title;        ///< with unit
  bool open_ended = false;  ///< the last colour also shows all values beyond `max`
};

/// Vertical bar of error_colour with labelled ticks on its right and the title above.
void draw_error_scale(Svg& svg, const Area& area, const ErrorScale& scale);

}  // namespace rtd::plot
