// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

struct MapCamera {
  vision::RgbdProjection projection;
  int width_px = 0, height_px = 0;
};
using MapCameras = std::vector<MapCamera>;

/// The cameras that the keyframes of a map were seen with, each once.
MapCameras cameras_of(const MapContents& contents);

/// How the camera of a frame differs from all cameras of a map, and what to do; empty when it is near one of them:
/// another specimen of the same kind finds its way in the map, another kind or a wrong calibration does not.
std::string difference_to(const MapCameras& cameras, const msg::FeatureFrame& frame);

}  // namespace rtd::slam
