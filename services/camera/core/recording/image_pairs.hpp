// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/camera/core/recording/frame_pairer.hpp"
#include "services/camera/core/recording/recording_source.hpp"
#include "services/camera/core/recording/transform_log.hpp"

namespace rtd::camera {

/// Metadata of the depth topic's channel in an MCAP file that we wrote: the units of a metre in the source's images.
inline constexpr const char* kDepthFactor = "depth_factor";

/// Frames from two topics of ROS images, one of their calibration and, where the recording has them, transforms.
class ImagePairs final : public FrameAssembly {
 public:
  /// Throws SourceError: topics, encodings, calibration. `recording` outlives this.
  ImagePairs(Recording& recording, const RecordingOptions& options);

  const SourceInfo& info() const override { return info_; }
  std::optional<std::int64_t> advance(SkipLog& skips) override;
  std::optional<SourceFrame> decode(SkipLog& skips) override;
  geometry::Trajectory groundtruth() const override;

 private:
  void load_calibration(const RecordingOptions& options);
  void look_at_first_images(bool depth_named);
  void take(RecordedMessage message, SkipLog& skips);

  Recording& recording_;
  ImageTopics topics_;
  std::string color_type_, depth_type_, camera_frame_;
  double float_unit_m_;  ///< of depth in floats
  SourceInfo info_;
  FramePairer pairer_;
  TransformLog transforms_;
  std::optional<FramePairer::Pair> pair_;  ///< gone to
  std::optional<std::int64_t> first_ns_;
  std::int64_t last_ns_ = 0;
};

}  // namespace rtd::camera
