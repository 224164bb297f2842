// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/source_uri.hpp"
#include "common/camera/synthetic/motion_sensors.hpp"
#include "common/camera/synthetic/scene.hpp"
#include "common/camera/synthetic/scene_camera.hpp"
#include "common/camera/synthetic/sensor.hpp"

namespace rtd::camera {

/// Which exposures of a camera are lost on the way: of every 100, a share at random places. A pure function of the
/// seed: any frame is found without counting from the first. Immutable.
class FrameDrops {
 public:
  /// `share`: of the exposures, [0, 0.9], rounded to hundredths.
  FrameDrops(double share, std::uint64_t seed);

  /// Number of the exposure that arrives as the `frame`-th, both from 0.
  std::uint64_t exposure_of(std::uint64_t frame) const;
  /// How many of the exposures before this one arrive.
  std::uint64_t arrived_before(std::uint64_t exposure) const;

 private:
  std::vector<std::uint64_t> arriving_in(std::uint64_t block) const;

  std::uint64_t lost_, seed_;  ///< of a block
};

/// The parameters of `synthetic:NAME?key=value`.
struct SyntheticOptions {
  synthetic::SceneSpec scene;
  std::uint64_t seed = 1;
  std::uint64_t frames = 0;  ///< 0 = endless
  double fps = 30;
  bool noise = true;
  int width = 640, height = 480;
  synthetic::SensorFaults faults;
  bool imu = false, wheels = false;    ///< there is an IMU in the camera, wheels below it
  double dark_from_s = 0, dark_s = 0;  ///< the light is off from this time on, for so long
  bool timing_known = false;  ///< frames say how the shutter rolls and how late depth is, as a calibrated camera's do
};

/// Reads scene and parameters; throws SourceError naming the parameter, its value, the range or the names known.
SyntheticOptions parse_synthetic_options(const SourceUri& uri);

/// Renders a scene: exact ground truth and masks of what moves. The same options give the same bits.
/// An exposure is made at every tick of the frame rate; those that FrameDrops leaves are the frames.
class SyntheticSource final : public FrameSource {
 public:
  SyntheticSource(std::string uri, const SyntheticOptions& options);

  std::optional<SourceFrame> next() override;
  std::uint64_t pass_over(std::int64_t stamp_ns) override;
  const SourceInfo& info() const override { return info_; }
  const SourceCounters& counters() const override { return counters_; }
  geometry::Trajectory groundtruth() const override;  ///< of all frames, endless: of those played
  std::vector<SkippedInput> take_skipped() override { return {}; }

 private:
  std::int64_t stamp_ns(std::uint64_t exposure) const;
  double time_s(std::uint64_t exposure) const;
  void add_motion(SourceFrame& frame, double t_s);
  bool at_end() const { return info_.frames != 0 && counters_.frames >= info_.frames; }

  SyntheticOptions options_;
  FrameDrops drops_;
  SourceInfo info_;
  SourceCounters counters_;
  synthetic::Scene scene_;
  synthetic::SceneCamera camera_;
  std::optional<synthetic::SyntheticImu> imu_;
  std::optional<synthetic::SyntheticWheels> wheels_;
  std::int64_t next_imu_ = 0;  ///< reading that was not given yet
};

}  // namespace rtd::camera
