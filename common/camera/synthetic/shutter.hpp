// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/camera/synthetic/renderer.hpp"
#include "common/camera/synthetic/scene.hpp"

namespace rtd::camera::synthetic {

/// How an image comes about over time.
struct Shutter {
  double readout_s = 0;   ///< from the first row to the last; 0 = all at once
  double exposure_s = 0;  ///< of each row; 0 = a moment
};

/// What the camera of a scene sees, its middle row exposed about `t_s`. Camera and moving objects continue while the
/// rows are read: every 8 rows are drawn for a moment of their own. Colour is the mean over the exposure; depth, mask
/// and objects are those in its middle. Costs one rendering per 4 ms of exposure; the readout costs next to nothing.
Rendering take_picture(Renderer& renderer, const Scene& scene, double t_s, const Shutter& shutter);

}  // namespace rtd::camera::synthetic
