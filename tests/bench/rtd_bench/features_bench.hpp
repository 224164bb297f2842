// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "tests/bench/rtd_bench/percentile.hpp"

namespace rtd::bench {

struct FeaturesOptions {
  int features = 1000;
  std::uint64_t frames = 200;
  std::uint64_t warm_up = 10;  ///< frames before, not counted
};

/// What one extractor did with the frames, one entry for each.
struct ExtractorTimes {
  std::string name;
  std::vector<double> wall_ms, cpu_ms;  ///< cpu: of the calling thread
  std::vector<int> found;               ///< features
  std::vector<double> spread;           ///< share of the image's 20 x 15 cells with at least one feature
};

struct FeaturesResult {
  int width = 0, height = 0;
  ExtractorTimes own, opencv;
};

/// Our ORB extractor and cv::ORB on the same frames in turn, one thread each; who goes first alternates. Ours also
/// undistorts, reads depth and spreads the features. Throws SourceError. `on_frame` receives the number of those done.
FeaturesResult bench_features(camera::FrameSource& source, const FeaturesOptions& options,
                              const std::function<void(std::uint64_t)>& on_frame);

/// A table for people, and the same as JSON text.
std::string features_table(const FeaturesResult& result, const FeaturesOptions& options, const std::string& source);
std::string features_json(const FeaturesResult& result, const FeaturesOptions& options, const std::string& source);

}  // namespace rtd::bench
