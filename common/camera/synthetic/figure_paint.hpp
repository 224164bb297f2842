// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {

/// The textures of a drawn person, as indices. All wrap round their ellipsoids.
struct PersonTextures {
  int head = 0, hair = 0, skin = 0;
  int chest = 0;  ///< front and back of what is worn above: buttons, a print, stripes, or an open jacket
  int cloth = 0;  ///< the same without them
  int forearm = 0;
  int hips = 0, leg = 0, shoe = 0;
};

/// Draws face, hair and clothes of a person, all chosen by the seed; adds them to `textures`.
PersonTextures draw_person(std::uint64_t seed, float breadth, std::vector<Texture>& textures);

}  // namespace rtd::camera::synthetic
