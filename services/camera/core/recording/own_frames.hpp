// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/msg/rgbd_frame.hpp"
#include "services/camera/core/recording/recording_source.hpp"

namespace rtd::camera {

/// Frames that our own recorder took from the topic rtd/frame: colour, depth and calibration in one message, the same
/// bytes as in memory.
class OwnFrames final : public FrameAssembly {
 public:
  /// The topic of such frames; empty when there is none.
  static std::string topic_of(const Recording& recording);
  /// Throws SourceError when no frame can be used. `recording` outlives this.
  explicit OwnFrames(Recording& recording);

  const SourceInfo& info() const override { return info_; }
  std::optional<std::int64_t> advance(SkipLog& skips) override;
  std::optional<SourceFrame> decode(SkipLog& skips) override;
  /// None: what slam says of the path is no truth.
  geometry::Trajectory groundtruth() const override { return {}; }

 private:
  bool take(const RecordedMessage& message, SkipLog& skips);

  Recording& recording_;
  SourceInfo info_;
  std::unique_ptr<msg::RgbdFrame> frame_;  ///< gone to
  std::uint64_t source_id_ = 0;
  std::optional<std::int64_t> last_ns_;
};

}  // namespace rtd::camera
