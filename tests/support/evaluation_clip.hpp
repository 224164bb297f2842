// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "common/vision/rgbd_image.hpp"

namespace rtd::test_support {

/// A recorded clip in TUM layout, with ground truth and, for rendered clips, the true dynamic pixels. Reads images when
/// asked.
class EvaluationClip {
 public:
  /// The clip `name` below RTD_DATA_DIR; empty when there is none (the caller skips its test).
  static std::optional<EvaluationClip> find(const std::string& name);
  explicit EvaluationClip(const std::string& directory);

  std::size_t size() const { return frames_.size(); }
  vision::RgbdImage image(std::size_t index) const;
  /// CV_8UC1, 255 = dynamic pixel; empty when the clip has no masks.
  cv::Mat dynamic_mask(std::size_t index) const;
  /// True pose of the camera in the frame of the first camera of the clip; identity when no stamp fits within 20 ms.
  const Eigen::Isometry3d& T_world_camera(std::size_t index) const { return frames_[index].T_world_camera; }

 private:
  struct Frame {
    std::int64_t stamp_ns;
    std::string color_path, depth_path, mask_path;
    Eigen::Isometry3d T_world_camera;
  };
  geometry::CameraModel camera_;
  std::vector<Frame> frames_;
};

}  // namespace rtd::test_support
