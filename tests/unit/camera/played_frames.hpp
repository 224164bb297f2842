// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/camera/open/source_factory.hpp"

namespace rtd::camera::test {

/// All that a source gives until its end.
struct Played {
  std::vector<SourceFrame> frames;
  SourceCounters counters;
  std::vector<SkippedInput> skipped;
};
inline Played play_all(const std::string& uri) {
  const auto source = make_source(uri);
  Played played;
  while (auto frame = source->next()) played.frames.push_back(std::move(*frame));
  played.counters = source->counters();
  played.skipped = source->take_skipped();
  return played;
}
inline std::vector<SourceFrame> play(const std::string& uri) {
  return play_all(uri).frames;
}

/// Whether there is no such source, for a reason in these words.
inline testing::AssertionResult refuses(const std::string& uri, const std::vector<std::string>& words) {
  try {
    make_source(uri);
  } catch (const SourceError& error) {
    const std::string text = error.what();
    for (const std::string& word : words)
      if (text.find(word) == std::string::npos)
        return testing::AssertionFailure() << "no '" << word << "' in: " << text;
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "was opened";
}

/// Of three frames at 1.0, 1.1 and 1.2 s: what is passed over keeps its seq.
inline void expect_passes_over_two_of_three(const std::string& uri) {
  const auto source = make_source(uri);
  EXPECT_EQ(source->pass_over(1'150'000'000), 2U);
  EXPECT_EQ(source->pass_over(1'150'000'000), 0U);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.stamp_ns, 1'200'000'000);
  EXPECT_EQ(frame->image.seq, 2U);
  EXPECT_FALSE(source->next());
}

inline bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_L1) == 0;
}

/// Share of the pixels of frame b that see at the predicted depth what frame a saw there, and their number.
struct Agreement {
  double share = 0;
  int pixels = 0;
};
inline Agreement agreement(const SourceFrame& a, const SourceFrame& b, const cv::Mat& left_out) {
  const geometry::CameraModel& camera = a.image.camera;
  const Eigen::Isometry3d T_b_a = b.T_world_camera->inverse() * *a.T_world_camera;
  int agreeing = 0, compared = 0;
  for (int v = 0; v < a.image.depth.rows; v += 3) {
    for (int u = 0; u < a.image.depth.cols; u += 3) {
      const double depth_m = a.image.depth.at<std::uint16_t>(v, u) * a.image.depth_scale_m;
      if (depth_m == 0 || left_out.at<std::uint8_t>(v, u) != 0) continue;
      const Eigen::Vector3d p_b = T_b_a * camera.unproject({u, v}, depth_m);
      const Eigen::Vector2d pixel = camera.project(p_b);
      if (p_b.z() < 0.5 || !camera.contains(pixel, 1)) continue;
      const cv::Point at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
      const double seen_m = b.image.depth.at<std::uint16_t>(at) * b.image.depth_scale_m;
      if (seen_m == 0 || b.dynamic_mask.at<std::uint8_t>(at) != 0) continue;
      ++compared;
      if (std::abs(seen_m - p_b.z()) < 0.01 + 0.01 * p_b.z()) ++agreeing;
    }
  }
  return {compared > 0 ? static_cast<double>(agreeing) / compared : 0.0, compared};
}

}  // namespace rtd::camera::test
