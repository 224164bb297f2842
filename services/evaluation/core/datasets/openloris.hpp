// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace rtd::eval {

/// Makes the folder `into` in TUM's layout of a sequence of OpenLORIS-Scene, for the colour camera of its D435i: lists,
/// calibration.yaml from sensors.yaml, the ground truth moved from the robot's base to the camera by trans_matrix.yaml,
/// and links to the images. Depth is in millimetres. Throws camera::SourceError naming file, cause and fix.
void prepare_openloris(const std::filesystem::path& sequence, const std::filesystem::path& into);

}  // namespace rtd::eval
