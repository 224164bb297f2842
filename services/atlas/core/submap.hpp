// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/io/bytes.hpp"
#include "common/msg/atlas.hpp"
#include "services/slam/core/map/map.hpp"

namespace rtd::atlas {

/// The features of a message; null when it is no frame of a camera. Those that are unusable are left out: `kept` then
/// says which feature of the message each one is.
slam::FramePtr to_frame(const msg::KeyframeFeatures& message, std::vector<std::uint32_t>& kept);

enum class KeptFeatures { kAll, kOfLandmarks };

/// Some keyframes of a map (ascending) as one map with the ids that they have, and the landmarks that they see.
/// kOfLandmarks: without the features that are no landmark's.
slam::MapContents take_part(const slam::Map& map, const std::vector<slam::KeyframeId>& keyframes, KeptFeatures kept);

/// Those as a map file.
io::Bytes to_map_file(slam::MapContents contents);

}  // namespace rtd::atlas
