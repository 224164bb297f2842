// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "services/slam/core/optimize/bundle_adjustment.hpp"

namespace rtd::test_support {

struct BundleSceneOptions {
  std::size_t keyframes = 20;  ///< adjusted; the first of them is held when there are no others
  std::size_t fixed_keyframes = 0;
  std::size_t landmarks = 2000;
  double detection_rate = 0.65;  ///< of the landmarks in view
  double depth_rate = 0.8;       ///< of the observations
  double outlier_rate = 0.02;    ///< of the observations: anywhere within 30 px
  double noise_px = 0.8;         ///< at the finest octave
  double pose_error_m = 0.01;    ///< of the start, with as many rad
  double point_error_m = 0.02;
  std::uint64_t seed = 1;
};

struct BundleScene {
  slam::BundleProblem truth, problem;
};

/// What local bundle adjustment meets: a camera that moved 1 m past landmarks 1 to 4 m away, octaves, some
/// measurements without depth, some wrong, poses and points a little off.
BundleScene make_bundle_scene(const BundleSceneOptions& options);

/// Largest distance of an adjusted camera from the truth, m.
double worst_camera_error_m(const BundleScene& scene);

}  // namespace rtd::test_support
