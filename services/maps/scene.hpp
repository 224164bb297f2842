// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "services/maps/map_report.hpp"

namespace rtd::maps {

/// A keyframe whose image is exported.
struct SceneImage {
  const slam::Keyframe* keyframe;
  std::string file;  ///< name of its file, and of its mask
};

/// A landmark with the colour of the first keyframe that sees it.
struct ScenePoint {
  const slam::Landmark* landmark;
  std::array<std::uint8_t, 3> rgb;
};

/// What Gaussian splatting starts from. Images are undistorted: a pinhole camera.
struct Scene {
  geometry::CameraModel::Parameters camera;
  std::vector<SceneImage> images;  ///< by time
  std::map<slam::LandmarkId, ScenePoint> points;
  bool masked = false;  ///< each image has a mask

  /// Where a keyframe saw a feature, px of the image; the middle of the first pixel is 0.5, 0.5 as in COLMAP.
  Eigen::Vector2d pixel_of(const slam::Keyframe& keyframe, std::size_t feature) const;
};

/// cameras.txt, images.txt and points3D.txt of COLMAP in `folder`. Throws io::IoError.
void write_colmap_model(const Scene& scene, const std::filesystem::path& folder);

/// transforms.json of nerfstudio, which names points.ply and images in `folder`. Throws io::IoError.
void write_transforms(const Scene& scene, const std::filesystem::path& folder);

/// The landmarks with their colours. Throws io::IoError.
void write_points(const Scene& scene, const std::filesystem::path& file);

}  // namespace rtd::maps
