// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/slam/core/map/map.hpp"

namespace rtd::test_support {

struct SampleMapOptions {
  std::uint32_t keyframes = 8;
  std::uint32_t features = 40;           ///< per keyframe
  std::uint32_t seen_per_keyframe = 16;  ///< landmarks of the keyframes before
  std::uint32_t new_per_keyframe = 6;    ///< landmarks
  std::uint64_t seed = 1;
};

/// A map of any size in moments: sound in every link, its geometry made up. A walk of 0.1 m steps.
slam::MapContents sample_contents(const SampleMapOptions& options);

/// The same as a map with some history: a keyframe and some landmarks were removed, and there is a second component.
slam::Map sample_map(const SampleMapOptions& options = {});

}  // namespace rtd::test_support
