// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <istream>
#include <string>
#include <vector>

#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::eval {

/// The points of a PLY text file as slam writes its landmarks (map.ply): x y z first, metres, at most `most`, evenly
/// spread. Empty for any other file.
std::vector<Eigen::Vector3d> read_landmarks(std::istream& in, std::size_t most);

/// Landmarks and path from above: seen along y or z of the map, whichever the landmarks spread over less. Empty without
/// landmarks.
std::string map_picture(const std::vector<Eigen::Vector3d>& landmarks_m, const Trajectory& estimate);

}  // namespace rtd::eval
