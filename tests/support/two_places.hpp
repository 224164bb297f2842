// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "tests/support/feature_world.hpp"

namespace rtd::test_support {

/// A desk at 0 m and a hall at kHallX_m side by side, so that a camera on the way along x sees both.
class TwoPlaces {
 public:
  static constexpr double kHallX_m = 7;

  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) const {
    auto frame = desk_.view(seq, T_world_camera);
    const auto hall = hall_.view(seq, Eigen::Translation3d(-kHallX_m, 0, 0) * T_world_camera);
    for (std::uint32_t i = 0; i < hall->count && frame->count < msg::kMaxFeatures; ++i) {
      frame->features[frame->count++] = hall->features[i];
    }
    return frame;
  }

 private:
  FeatureWorld desk_ = FeatureWorld::noisy(1), hall_ = FeatureWorld::noisy(2);
};

}  // namespace rtd::test_support
