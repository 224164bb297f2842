// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>

#include "common/map_page/map_page.hpp"
#include "services/evaluation/core/report/run_summary.hpp"

namespace rtd::eval {

/// The points of static_map.ply as dense writes it; none of any other file.
map_page::Layer read_static_map(std::istream& in);

/// The points of a PLY text file as slam writes its landmarks (map.ply): x y z first, metres, at most `most`, evenly
/// spread. Empty for any other file.
std::vector<Eigen::Vector3d> read_landmarks(std::istream& in, std::size_t most);

/// What a run left, to look at in a browser: the dense map if there is one, landmarks, path and ground truth.
map_page::Page map_page_of(const Run& run, const RunSummary& summary);

}  // namespace rtd::eval
