// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/filter_quality.hpp"

#include <algorithm>

#include "common/service/monotonic_clock.hpp"

namespace rtd::test_support {
FilterQuality measure_filter(
    const EvaluationClip& clip, const filter::FilterConfig& config,
    const std::function<void(const vision::RgbdImage&, const filter::FilterResult&)>& on_frame) {
  filter::DynamicFilter dynamic_filter(config, service::monotonic_ns);
  FilterQuality quality;
  quality.frames = clip.size();
  for (std::size_t i = 0; i < clip.size(); ++i) {
    const vision::RgbdImage image = clip.image(i);
    const filter::FilterResult result = dynamic_filter.apply(image, std::nullopt);
    quality.count(run_record::judged(result.features), clip.dynamic_mask(i));
    const Eigen::Isometry3d T_true_estimated = clip.T_world_camera(i).inverse() * result.T_world_camera;
    quality.max_pose_error_m = std::max(quality.max_pose_error_m, T_true_estimated.translation().norm());
    for (std::size_t stage = 0; stage < quality.stage_ms.size(); ++stage) {
      quality.stage_ms[stage] += static_cast<double>(result.stage_ms[stage]) / static_cast<double>(clip.size());
    }
    if (on_frame) on_frame(image, result);
  }
  return quality;
}

}  // namespace rtd::test_support
