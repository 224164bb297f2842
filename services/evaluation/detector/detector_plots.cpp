// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/detector_report.hpp"

#include <array>
#include <limits>

#include "services/evaluation/core/plot/chart.hpp"
#include "services/evaluation/core/report/html.hpp"

namespace rtd::eval {
namespace {

using plot::Chart;
using plot::Svg;

constexpr double kWidth = 900, kHeight = 420, kNoGap = std::numeric_limits<double>::infinity();
constexpr plot::Area kArea{70, 50, 800, 300};
constexpr int kSteps = 100;

std::string colour_of(std::size_t model) {
  static constexpr std::array<const char*, 5> kColours = {
      plot::palette::kBlue, plot::palette::kRed, plot::palette::kGreen, plot::palette::kAmber, plot::palette::kPurple};
  return kColours[model % kColours.size()];
}

template <class Results>
void draw_model_legend(Svg& svg, const Results& results) {
  std::vector<plot::LegendEntry> entries;
  for (std::size_t i = 0; i < results.models.size(); ++i)
    entries.push_back({results.models[i].model.name, colour_of(i)});
  plot::draw_legend(svg, {kArea.x, 28}, entries);
}

/// Pixel recall at the lowest threshold by roll.
void draw_roll_curve(Chart& chart, const RecallByRoll& by_roll, const plot::Stroke& stroke) {
  std::vector<double> rolls_deg, recalls;
  for (const auto& [roll_deg, by_threshold] : by_roll) {
    rolls_deg.push_back(roll_deg);
    recalls.push_back(by_threshold.begin()->second.pixel_recall());
  }
  chart.curve(rolls_deg, recalls, stroke, kNoGap);
}

std::string preformatted(const std::string& text) {
  return "<pre style=\"overflow-x:auto\">" + plot::escape_markup(text) + "</pre>";
}

}  // namespace

Svg threshold_plot(const LabelledResults& results) {
  Svg svg(kWidth, kHeight, "precision and recall over the confidence threshold");
  Chart chart(svg, kArea, {0, 1}, {0, 1});
  chart.draw_axes({"confidence threshold (high motion level; solid: recall, dashed: precision)", "share"});
  draw_model_legend(svg, results);
  for (std::size_t i = 0; i < results.models.size(); ++i) {
    const auto high = results.models[i].accuracy.groups.find("high");
    if (high == results.models[i].accuracy.groups.end()) continue;
    std::vector<double> thresholds, precision, recall;
    for (int step = 1; step < kSteps; ++step) {
      const detector::OperatingPoint point = at_threshold(high->second.curve, step / double(kSteps));
      if (point.recall <= 0) break;  // nothing is found any more: precision says nothing
      thresholds.push_back(point.threshold);
      precision.push_back(point.precision);
      recall.push_back(point.recall);
    }
    chart.curve(thresholds, recall, {colour_of(i), 2}, kNoGap);
    chart.curve(thresholds, precision, {colour_of(i), 1.5, "5 4"}, kNoGap);
  }
  return svg;
}

Svg roll_plot(const MaskResults& results) {
  Svg svg(kWidth, kHeight, "recall over roll");
  std::vector<double> rolls_deg;
  for (const auto& [roll_deg, recall] : results.models.front().as_seen) rolls_deg.push_back(roll_deg);
  Chart chart(svg, kArea, plot::range_of(rolls_deg), {0, 1});
  chart.draw_axes({"roll [deg] (dashed: as the camera sees it, solid: turned upright)", "pixel recall"});
  draw_model_legend(svg, results);
  for (std::size_t i = 0; i < results.models.size(); ++i) {
    draw_roll_curve(chart, results.models[i].as_seen, {colour_of(i), 2, "5 4"});
    draw_roll_curve(chart, results.models[i].upright, {colour_of(i), 2});
  }
  return svg;
}

std::string labelled_html(const LabelledResults& results) {
  return html::page("Detector accuracy", input_lines(results.input, "without label file (no objects)"),
                    html::section("Models", "", preformatted(labelled_table(results))) +
                        html::section("Thresholds", "", threshold_plot(results).str()));
}

std::string mask_html(const MaskResults& results) {
  return html::page("Detector recall on masks", input_lines(results.input, "without mask (left out)"),
                    html::section("Recall over roll", "", roll_plot(results).str()) +
                        html::section("Figures", "", preformatted(mask_table(results))));
}

}  // namespace rtd::eval
