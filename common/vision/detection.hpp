// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::vision {

/// One detected object: an axis-parallel box in pixels of the camera's own image.
struct Detection {
  std::string class_name;  ///< COCO name, e.g. "person"
  float score = 0;         ///< [0, 1]
  float x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< top-left corner and size
};

}  // namespace rtd::vision
