// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/camera/core/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {

/// Inner size of the room, m; the world frame's origin is on the floor in its middle, y towards the front wall.
inline constexpr float kRoomWidthM = 7.0F, kRoomDepthM = 6.4F, kRoomHeightM = 2.8F;

/// The furnished room: walls, floor, ceiling, shelves and cabinets along the walls, a low table with things on it
/// behind the movers, boxes. Nothing stands in CameraRoom. Adds its textures to `textures`.
std::vector<Face> build_room(std::uint64_t seed, std::vector<Texture>& textures);

}  // namespace rtd::camera::synthetic
