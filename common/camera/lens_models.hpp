// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/geometry/camera_model.hpp"

namespace rtd::camera {

/// How drivers and programs have a lens bend the image; the coefficients are k1 k2 p1 p2 k3 (k4 k5 k6) unless said.
enum class LensModel {
  kBrownConrady,  ///< also the rational model of OpenCV
  kModified,      ///< Brown-Conrady with the tangential part of the point that the radial part has moved (librealsense)
  kInverse,       ///< the formula of Brown-Conrady leads from the camera's own image to the ideal one (librealsense)
  kFisheye,       ///< equidistant, Kannala-Brandt: k1 k2 k3 k4
  kNone,          ///< whatever the coefficients are
  kUnknown,
};

/// By the name that a driver or program gives it, in any spelling: "plumb_bob", "Inverse Brown Conrady",
/// "KANNALA_BRANDT4". Empty: Brown-Conrady. kUnknown for every other name.
LensModel lens_model(const std::string& name);

/// The error for a lens whose model, or number of coefficients, is not known: names the model and those that are.
std::string no_such_lens(const std::string& model);

/// `camera`, whose coefficients are those of `model`, with coefficients of a model of geometry::Lens. Inverse and
/// modified ones become the rational model that differs by less than kLensFit_px in the image, with a margin of 5 %.
/// Throws SourceError naming `origin` when none does.
geometry::CameraModel::Parameters with_lens(const geometry::CameraModel::Parameters& camera, LensModel model,
                                            const std::string& origin);
inline constexpr double kLensFit_px = 0.1;

}  // namespace rtd::camera
