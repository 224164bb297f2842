// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/report_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/vision/jpeg_size.hpp"
#include "services/evaluation/core/plot/chart.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"

namespace rtd::eval {
namespace {

using plot::Anchor;
using plot::Area;
using plot::Chart;
using plot::Point;
namespace palette = plot::palette;

constexpr double kChartWidth = 1080;
constexpr std::size_t kMaxColumns = 700;  // more values are averaged: a chart has no more columns

/// Per-frame values over time, averaged to at most kMaxColumns.
struct FeatureSeries {
  std::vector<double> time_s, kept, total, inliers;
};

FeatureSeries feature_series(const Run& run, const RunTime& time) {
  FeatureSeries series;
  const std::size_t bucket = run.frames.size() / kMaxColumns + 1;
  for (std::size_t begin = 0; begin < run.frames.size(); begin += bucket) {
    const std::size_t end = std::min(begin + bucket, run.frames.size());
    double time_s = 0, kept = 0, removed = 0, inliers = 0;
    for (std::size_t i = begin; i < end; ++i) {
      time_s += source_time_s(run.frames[i], time);
      kept += run.frames[i].tracking.features_static;
      removed += run.frames[i].tracking.features_removed;
      inliers += run.frames[i].tracking.inliers;
    }
    const auto n = static_cast<double>(end - begin);
    series.time_s.push_back(time_s / n);
    series.kept.push_back(kept / n);
    series.total.push_back((kept + removed) / n);
    series.inliers.push_back(inliers / n);
  }
  return series;
}

/// Area between two curves over the same times.
void fill_between(plot::Svg& svg, const Chart& chart, const std::vector<double>& x, const std::vector<double>& low,
                  const std::vector<double>& high, const char* colour) {
  std::vector<Point> outline = chart.at(x, high);
  std::vector<Point> back = chart.at(x, low);
  outline.insert(outline.end(), back.rbegin(), back.rend());
  svg.polygon(outline, colour, 0.72);
}

void mark_lost(Chart& chart, const RunSummary& summary, const RunTime& time, std::size_t frames) {
  const double period_s = frames > 1 ? time.duration_s / static_cast<double>(frames - 1) : 0.033;
  for (const LostFrames& span : summary.lost) {
    chart.band(span.start_s, span.start_s + static_cast<double>(span.frames()) * period_s, palette::kRed, 0.18);
  }
}

struct LatencySeries {
  std::vector<double> time_s, ms;
};

LatencySeries latency_series(const Run& run, const RunTime& time) {
  LatencySeries series;
  for (const run_record::FrameRecord& frame : run.frames) {
    const auto latency = latency_ms(frame);
    if (!latency) continue;
    series.time_s.push_back(source_time_s(frame, time));
    series.ms.push_back(*latency);
  }
  return series;
}

/// A few extreme values must not flatten everything else: the axis then ends above p99 and the chart says what lies
/// beyond.
double latency_axis_end_ms(const TimeSummary& latency) {
  return latency.max > 2.2 * latency.p99 ? 1.5 * latency.p99 : 1.06 * latency.max;
}

void draw_latency_dots(plot::Svg& svg, const Chart& chart, const LatencySeries& series) {
  std::vector<Point> inside, beyond;
  const std::size_t stride = series.ms.size() / 6000 + 1;
  for (std::size_t i = 0; i < series.ms.size(); ++i) {
    const bool above = series.ms[i] > chart.y().max;
    if (above) beyond.push_back(chart.at(series.time_s[i], chart.y().max));
    if (!above && i % stride == 0) inside.push_back(chart.at(series.time_s[i], series.ms[i]));
  }
  svg.dots(inside, 3.6, palette::kBlue, 0.65);
  for (const Point& p : beyond) svg.polygon({{p.x - 4, p.y + 8}, {p.x + 4, p.y + 8}, {p.x, p.y}}, palette::kRed);
}

/// The distribution as bars that share the chart's vertical axis.
void draw_marginal(plot::Svg& svg, const Chart& chart, const LatencySeries& series, double width) {
  constexpr std::size_t kBins = 36;
  std::vector<double> bins(kBins, 0.0);
  for (const double ms : series.ms) {
    const double position = ms / chart.y().max * kBins;
    if (position >= 0 && position < kBins) ++bins[static_cast<std::size_t>(position)];
  }
  const double highest = std::max(1.0, *std::ranges::max_element(bins));
  const double left = chart.area().x + chart.area().width + 6, height = chart.area().height / kBins;
  for (std::size_t i = 0; i < kBins; ++i) {
    const double y = chart.area().y + chart.area().height - static_cast<double>(i + 1) * height;
    svg.rect({left, y + 0.5, bins[i] / highest * width, height - 1}, palette::kBlue, 0.45);
  }
}

void draw_percentile(plot::Svg& svg, const Chart& chart, double ms, const std::string& name, const char* colour,
                     double label_shift) {
  if (!std::isfinite(ms) || ms > chart.y().max) return;
  const double right = chart.area().x + chart.area().width + 100, py = chart.at(0, ms).y;
  svg.line({chart.area().x, py}, {right, py}, {colour, 1.3, "6 4"});
  svg.text({right + 5, py + 4 + label_shift}, fmt::format("{} {:.1f}", name, ms), {colour, 12, Anchor::kStart, true});
}

bool is_total(const StageSummary& stage) {
  return stage.name.size() > 6 && stage.name.compare(stage.name.size() - 6, 6, ".total") == 0;
}

void draw_stage_row(plot::Svg& svg, const StageSummary& stage, double y, double ms_to_px) {
  constexpr double kLeft = 190;
  const char* colour = stage.name.starts_with("filter") ? palette::kBlue : palette::kPurple;
  const double p50 = kLeft + stage.ms.p50 * ms_to_px, p99 = kLeft + stage.ms.p99 * ms_to_px;
  svg.text({kLeft - 12, y + 4}, stage.name, {palette::kInk, 12.5, Anchor::kEnd, is_total(stage)});
  svg.rect({kLeft, y - 7, p50 - kLeft, 14}, colour, is_total(stage) ? 0.95 : 0.6, 2);
  svg.line({p50, y}, {p99, y}, {colour, 1.6});
  svg.line({p99, y - 5}, {p99, y + 5}, {colour, 1.6});
  svg.text({p99 + 9, y + 4}, fmt::format("{:.2f} / {:.2f} ms", stage.ms.p50, stage.ms.p99), {palette::kMuted, 12});
  svg.text({kChartWidth - 10, y + 4}, fmt::format("{} frames", stage.ms.count), {palette::kMuted, 12, Anchor::kEnd});
}

/// People as bars of equal labels in each row of their grid.
void draw_masks(plot::Svg& svg, const vision::PersonMasks& masks) {
  constexpr double kStep = vision::kMaskStepPx;
  for (int row = 0; row < masks.rows; ++row) {
    for (int begin = 0, end = 0; begin < masks.columns; begin = end) {
      const std::uint8_t label = masks.at(begin, row);
      for (end = begin + 1; end < masks.columns && masks.at(end, row) == label;) ++end;
      if (label != 0) svg.rect({begin * kStep, row * kStep, (end - begin) * kStep, kStep}, "#ffb000", 0.45);
    }
  }
}

std::string caption(const run_record::SampleFrame& sample) {
  const auto removed =
      std::ranges::count_if(sample.features, [](const run_record::JudgedFeature& feature) { return feature.removed; });
  return fmt::format("frame {}: {} kept, {} removed", sample.seq,
                     sample.features.size() - static_cast<std::size_t>(removed), removed);
}

}  // namespace

double source_time_s(const run_record::FrameRecord& frame, const RunTime& time) {
  return static_cast<double>(frame.tracking.stamp_ns - time.start_ns) * 1e-9;
}

RunTime run_time(const Run& run, const RunSummary& summary) {
  if (!run.frames.empty()) {
    const std::int64_t start_ns = run.frames.front().tracking.stamp_ns;
    return {start_ns, std::max(0.0, static_cast<double>(run.frames.back().tracking.stamp_ns - start_ns) * 1e-9)};
  }
  if (summary.estimate.empty()) return {};
  const std::int64_t start_ns = summary.estimate.front().stamp_ns;
  return {start_ns, static_cast<double>(summary.estimate.back().stamp_ns - start_ns) * 1e-9};
}

Trajectory truth_during(const RunSummary& summary, const RunTime& time) {
  const auto end_ns = time.start_ns + std::llround(time.duration_s * 1e9);
  return within(summary.groundtruth, time.start_ns, end_ns);
}

std::string points_chart(const Run& run, const RunSummary& summary) {
  const RunTime time = run_time(run, summary);
  const FeatureSeries series = feature_series(run, time);
  plot::Svg svg(kChartWidth, 300, "Features per frame, kept and removed, over time");
  Chart chart(svg, {64, 30, kChartWidth - 64 - 20, 224}, {0, std::max(time.duration_s, 1e-3)},
              plot::range_from_zero(series.total));
  chart.draw_axes({"time since the first frame [s]", "features per frame"});
  fill_between(svg, chart, series.time_s, std::vector<double>(series.kept.size(), 0.0), series.kept, palette::kGreen);
  fill_between(svg, chart, series.time_s, series.kept, series.total, palette::kRed);
  chart.curve(series.time_s, series.inliers, {palette::kInk, 1.5}, kMaxGapS);
  mark_lost(chart, summary, time, run.frames.size());
  std::vector<plot::LegendEntry> legend{{"kept as static", palette::kGreen},
                                        {"removed as dynamic", palette::kRed},
                                        {"used for the pose (inliers)", palette::kInk}};
  if (!summary.lost.empty()) legend.push_back({"no pose", "#f3c6c8"});
  plot::draw_legend(svg, {64, 15}, legend);
  return svg.str();
}

std::string latency_chart(const Run& run, const RunSummary& summary) {
  const RunTime time = run_time(run, summary);
  const LatencySeries series = latency_series(run, time);
  const TimeSummary& latency = summary.latency_ms;
  plot::Svg svg(kChartWidth, 300, "Latency from camera to pose over time and its distribution");
  const double end_ms = latency.count > 0 ? latency_axis_end_ms(latency) : 1;
  Chart chart(svg, {64, 30, kChartWidth - 64 - 190, 224}, {0, std::max(time.duration_s, 1e-3)},
              {0, std::max(end_ms, 1e-3)});
  chart.draw_axes({"time since the first frame [s]", "camera to pose [ms]"});
  draw_latency_dots(svg, chart, series);
  draw_marginal(svg, chart, series, 88);
  const double labels_px = (latency.p99 - latency.p50) / chart.y().span() * chart.area().height;
  const double apart = std::isfinite(labels_px) ? std::max(0.0, (15 - labels_px) / 2) : 0.0;
  draw_percentile(svg, chart, latency.p50, "p50", palette::kGreen, apart);
  draw_percentile(svg, chart, latency.p99, "p99", palette::kAmber, -apart);
  const auto beyond = std::ranges::count_if(series.ms, [&](double ms) { return ms > chart.y().max; });
  std::vector<plot::LegendEntry> legend{{"one frame", palette::kBlue, true}};
  if (beyond > 0)
    legend.push_back({fmt::format("{} above the axis, up to {:.0f} ms", beyond, latency.max), palette::kRed, true});
  plot::draw_legend(svg, {64, 15}, legend);
  return svg.str();
}

std::string stage_chart(const RunSummary& summary) {
  constexpr double kRowHeight = 26;
  std::vector<StageSummary> ran;
  std::ranges::copy_if(summary.stages, std::back_inserter(ran), [](const StageSummary& s) { return s.ms.count > 0; });
  double longest_ms = 1e-6;
  for (const StageSummary& stage : ran) longest_ms = std::max(longest_ms, stage.ms.p99);
  plot::Svg svg(kChartWidth, 34 + kRowHeight * static_cast<double>(ran.size()),
                "Time of each stage: median and 99th percentile");
  plot::draw_legend(svg, {190, 15}, {{"filter", palette::kBlue}, {"slam", palette::kPurple}});
  svg.text({kChartWidth - 10, 15}, "bar: p50, whisker: p99, over the frames in which the stage ran",
           {palette::kMuted, 12, Anchor::kEnd});
  for (std::size_t i = 0; i < ran.size(); ++i) {
    draw_stage_row(svg, ran[i], 44 + kRowHeight * static_cast<double>(i), (kChartWidth - 190 - 240) / longest_ms);
  }
  return svg.str();
}

std::string sample_picture(const run_record::SampleFrame& sample) {
  const auto [width, height] = vision::jpeg_size(sample.jpeg);
  if (width <= 0 || height <= 0) return "";
  plot::Svg svg(width, height, fmt::format("Frame {} with its features", sample.seq));
  svg.jpeg({0, 0, static_cast<double>(width), static_cast<double>(height)}, sample.jpeg);
  draw_masks(svg, sample.masks);
  std::vector<Point> kept, removed;
  for (const run_record::JudgedFeature& feature : sample.features)
    (feature.removed ? removed : kept).push_back({feature.u_raw_px, feature.v_raw_px});
  svg.dots(kept, 6, "#06351b", 0.55);
  svg.dots(kept, 4.4, "#35e07a");
  svg.dots(removed, 7, "#ffffff", 0.6);
  svg.dots(removed, 5.4, "#f5222d");
  return svg.str();
}

std::string number_text(double value, int decimals, const std::string& unit) {
  if (!std::isfinite(value)) return "unknown";
  return fmt::format("{:.{}f}{}{}", value, decimals, unit.empty() ? "" : " ", unit);
}

std::string percent_text(double fraction) {
  if (!std::isfinite(fraction)) return "unknown";
  // Never round up to 100 %: one lost frame must show.
  const double percent = fraction < 1 ? std::floor(fraction * 1e4 + 1e-6) / 100 : fraction * 100;
  return fmt::format("{:.{}f} %", percent, fraction == 1 ? 0 : 2);
}

std::vector<html::Figure> sample_figures(const Run& run, std::size_t wanted) {
  std::vector<html::Figure> figures;
  const std::size_t count = std::min(wanted, run.samples.size());
  for (std::size_t i = 0; i < count; ++i) {
    const run_record::SampleFrame& sample = run.samples[(2 * i + 1) * run.samples.size() / (2 * count)];
    std::string picture = sample_picture(sample);
    if (!picture.empty()) figures.push_back({std::move(picture), caption(sample)});
  }
  return figures;
}

}  // namespace rtd::eval
