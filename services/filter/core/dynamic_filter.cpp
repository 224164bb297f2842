// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/dynamic_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/msg/stamps.hpp"
#include "services/filter/core/modes/mode_table.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kTurnsNs = 4'000'000'000;  // older than any view that a frame is compared with

}  // namespace

/// What all modes share: surfaces, objects, the verdict of the mode. That of our own modes is RtdJudge::judge(),
/// docs/theory/dynamic_points.md.
FilterResult DynamicFilter::judge(const vision::RgbdImage& image, Extraction extraction,
                                  const DetectorUpdate& detector) {
  std::vector<msg::Feature> features = std::move(extraction.features);
  if (config_.mode == FilterMode::kOff)
    return complete({.features = std::move(features)}, {}, {}, StageClock(now_ns_), extraction.ms);
  StageClock clock(now_ns_);
  Surfaces surfaces = divide_into_surfaces(image);
  const std::vector<SceneObject> objects = find_objects(image, surfaces, detector);  // boxes to masks, tracks
  clock.finish(msg::kStageMasks);
  Verdict verdict = judge_->judge({image, surfaces, objects, detector.active, &gyroscope_}, std::move(features), clock);
  grid_ = std::move(surfaces.grid);
  gyroscope_.forget_before(msg::minus_ns(image.stamp_ns, kTurnsNs));
  return complete(std::move(verdict), objects, grid_.shape, clock, extraction.ms);
}

DynamicFilter::DynamicFilter(const FilterConfig& config, std::function<std::int64_t()> now_ns)
    : configured_(config),
      config_(effective_config(config)),
      now_ns_(std::move(now_ns)),
      extractor_(config.orb),
      sampler_(config.orb.min_depth_m, config.orb.max_depth_m),
      objects_(config_),
      gyroscope_(config.gyroscope),
      judge_(entry_of(config_.mode).make_judge(config_)) {
  choose_feature_count();
}

Extraction DynamicFilter::extract(const vision::RgbdImage& image) {
  StageClock clock(now_ns_);
  std::vector<msg::Feature> features = extractor_.extract(image, wanted_features_, first_octave_);
  clock.finish(msg::kStageExtract);
  return {std::move(features), clock.times_ms()[msg::kStageExtract]};
}

/// More while something is masked, so that enough are left.
void DynamicFilter::choose_feature_count() {
  const bool more = something_masked_ && config_.mode != FilterMode::kOff;
  const double wanted = config_.orb.feature_count * effort_.feature_share * (more ? config_.fusion.boost : 1.0);
  wanted_features_ = static_cast<int>(std::lround(wanted));
}

Surfaces DynamicFilter::divide_into_surfaces(const vision::RgbdImage& image) {
  DepthGrid grid = sampler_.sample(image);
  DepthClusters clusters = find_depth_clusters(grid, config_.clusters);
  return {std::move(grid), std::move(clusters), sampler_.rays()};
}

std::vector<SceneObject> DynamicFilter::find_objects(const vision::RgbdImage& image, const Surfaces& surfaces,
                                                     const DetectorUpdate& detector) {
  if (!looks_at_boxes(config_.mode)) return {};
  return objects_.track(detector, image, surfaces.grid, surfaces.clusters, judge_->views());
}

FilterResult DynamicFilter::complete(Verdict verdict, std::vector<SceneObject> objects, const GridShape& cells,
                                     const StageClock& clock, float extract_ms) {
  const auto removed = std::count_if(verdict.features.begin(), verdict.features.end(),
                                     [](const msg::Feature& f) { return (f.flags & msg::kFeatureRemoved) != 0; });
  something_masked_ = removed > 0;
  choose_feature_count();
  StageTimes stage_ms = clock.times_ms();
  stage_ms[msg::kStageExtract] = extract_ms;
  stage_ms[msg::kStageFilterTotal] = std::accumulate(stage_ms.begin(), stage_ms.begin() + msg::kStageFilterTotal, 0.0F);
  return {std::move(verdict), std::move(objects), static_cast<std::uint32_t>(removed), cells, stage_ms};
}

void DynamicFilter::set_mode(FilterMode mode) {
  configured_.mode = mode;
  config_ = effective_config(configured_);
  objects_ = ObjectTracker(config_);
  judge_ = entry_of(mode).make_judge(config_);
  judge_->set_coarse(effort_.coarse_depth_check);
  something_masked_ = true;
  choose_feature_count();
}

void DynamicFilter::set_effort(const Effort& effort) {
  effort_ = effort;
  first_octave_ = effort.first_octave;
  judge_->set_coarse(effort.coarse_depth_check);
  choose_feature_count();
}

void DynamicFilter::reset() {
  judge_->reset();
  objects_.clear();
  gyroscope_.clear();
  something_masked_ = true;
  choose_feature_count();
}

}  // namespace rtd::filter
