// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/map_file.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "services/slam/core/store/map_format.hpp"

namespace rtd::slam {
namespace {

constexpr double kTolerance = 0.05;  ///< of the focal length; Kinects differ by less than 0.04

bool is_near(const MapCamera& camera, const FrameRaster& frame) {
  const vision::RgbdProjection &p = camera.projection, &q = frame.camera;
  const double most_px = kTolerance * p.fx;
  return frame.width_px == camera.width_px && frame.height_px == camera.height_px && std::abs(q.fx - p.fx) < most_px &&
         std::abs(q.fy - p.fy) < most_px && std::abs(q.cx - p.cx) < most_px && std::abs(q.cy - p.cy) < most_px;
}

std::string text(int width, int height, double fx, double fy, double cx, double cy) {
  return fmt::format("{}x{} fx {:.1f} fy {:.1f} cx {:.1f} cy {:.1f}", width, height, fx, fy, cx, cy);
}

}  // namespace

std::uint64_t save_map_file(const std::filesystem::path& path, const MapSnapshot& snapshot, io::NamedBy named_by) {
  io::AtomicFile file(path, {.named_by = named_by});
  write_map(snapshot, file);
  file.commit();
  return file.position();
}

MapContents load_map_file(const std::filesystem::path& path, const MapReadOptions& options, io::Links links) {
  const io::FileSource source(path, links);
  try {
    return read_map(source, options);
  } catch (const MapFileError& error) {
    throw MapFileError(error.defect(), path.string() + ": " + error.what());
  }
}

MapCameras cameras_of(const MapContents& contents) {
  MapCameras cameras;
  for (const Keyframe& keyframe : contents.keyframes) {
    const Frame& frame = *keyframe.frame;
    const auto known = [&](const MapCamera& camera) { return camera.is_of(frame); };
    if (std::none_of(cameras.rbegin(), cameras.rend(), known))
      cameras.push_back({frame.camera, frame.width_px, frame.height_px});
  }
  return cameras;
}

std::string difference_to(const MapCameras& cameras, const msg::FeatureFrame& frame) {
  if (cameras.empty()) return {};
  if (std::ranges::any_of(cameras, [&](const MapCamera& camera) { return is_near(camera, raster_of(frame)); }))
    return {};
  const auto& [fx, fy, cx, cy] = frame.intrinsics;
  const MapCamera& camera = cameras.front();
  const vision::RgbdProjection& p = camera.projection;
  return fmt::format(
      "the camera ({}) is not that of the map ({}): give the calibration that the map was made with, or map again "
      "without --map",
      text(static_cast<int>(frame.width), static_cast<int>(frame.height), fx, fy, cx, cy),
      text(camera.width_px, camera.height_px, p.fx, p.fy, p.cx, p.cy));
}

}  // namespace rtd::slam
