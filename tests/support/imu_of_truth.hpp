// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/synthetic/motion_sensors.hpp"

namespace rtd::test_support {

/// The IMU that a recording with ground truth would have had: in the optical frame of the camera, which moves smoothly
/// through the true poses, with the noise and the biases of a cheap one, by default.
class ImuOfTruth {
 public:
  using Options = camera::synthetic::SyntheticImu::Options;
  /// `truth`: in order of time, two poses at least, else std::invalid_argument.
  ImuOfTruth(const geometry::Trajectory& truth, const Options& options, std::uint64_t seed);

  /// The readings since the last call, the first of them 0.1 s before the first frame.
  std::vector<camera::ImuReading> until(std::int64_t stamp_ns);

 private:
  std::int64_t first_ns_;
  camera::synthetic::SyntheticImu imu_;
  std::int64_t next_ = -1;  ///< index of the next reading, -1 before the first
};

}  // namespace rtd::test_support
