// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/guided_matching.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "common/vision/features.hpp"
#include "common/vision/reprojection.hpp"

namespace rtd::filter {
namespace {

struct Best {
  std::uint32_t index = 0;
  int hamming = std::numeric_limits<int>::max(), second = std::numeric_limits<int>::max();
};

Best nearest_descriptor(const msg::Feature& wanted, const SearchableFeatures& current,
                        const vision::SearchWindow& window) {
  Best best;
  current.grid.for_each(window, [&](std::uint32_t index) {
    const int hamming = vision::hamming_distance(wanted.descriptor, current.features[index].descriptor);
    if (hamming < best.hamming) {
      best.second = best.hamming;
      best.hamming = hamming;
      best.index = index;
    } else if (hamming < best.second) {
      best.second = hamming;
    }
  });
  return best;
}

/// Of several matches of one current feature, the best is kept.
std::vector<FeatureMatch> make_unique(std::vector<FeatureMatch> matches, std::size_t feature_count) {
  std::vector<int> best(feature_count, std::numeric_limits<int>::max());
  for (const FeatureMatch& match : matches) best[match.current] = std::min(best[match.current], match.hamming);
  std::erase_if(matches, [&](const FeatureMatch& match) {
    if (match.hamming != best[match.current]) return true;
    best[match.current] = -1;  // a second match at the same distance is dropped
    return false;
  });
  return matches;
}

}  // namespace

double search_window_px(const geometry::CameraModel& camera, std::int64_t age_ns, const EgoMotionConfig& config) {
  constexpr double kShortest_s = 0.1, kMost_rad = 0.2;  // even the last frame is known no better
  const double age_s = std::max(kShortest_s, 1e-9 * static_cast<double>(age_ns));
  return camera.parameters().fx * std::min(kMost_rad, config.window_rad_s * age_s);
}

std::vector<FeatureMatch> match_by_projection(const View& reference, const SearchableFeatures& current,
                                              const Eigen::Isometry3d& T_world_camera, double window_px,
                                              const EgoMotionConfig& config, double reach_m) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  const double reach_px_m = reach_m * current.camera.parameters().fx;
  std::vector<FeatureMatch> matches;
  for (std::uint32_t i = 0; i < reference.features.size(); ++i) {
    const msg::Feature& feature = reference.features[i];
    if (feature.depth_m <= 0) continue;
    const Eigen::Vector3d p_world =
        reference.T_world_camera * current.camera.unproject({feature.u_px, feature.v_px}, feature.depth_m);
    const Eigen::Vector3d p_camera = T_camera_world * p_world;
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    const Eigen::Vector2d pixel = current.camera.project(p_camera);
    if (!current.camera.contains(pixel)) continue;
    const vision::SearchWindow window{static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                                      static_cast<float>(window_px + reach_px_m / p_camera.z()), feature.octave - 1,
                                      feature.octave + 1};
    const Best best = nearest_descriptor(feature, current, window);
    if (best.hamming > config.max_hamming || best.hamming > config.max_ratio * best.second) continue;
    matches.push_back({best.index, i, best.hamming, (feature.flags & msg::kFeatureRemoved) == 0, p_world});
  }
  return make_unique(std::move(matches), current.features.size());
}

}  // namespace rtd::filter
