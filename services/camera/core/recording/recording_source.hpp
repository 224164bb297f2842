// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/recording/recording.hpp"
#include "services/camera/core/recording/topic_choice.hpp"

namespace rtd::camera {

/// What the frames of a recording are made of.
class FrameAssembly {
 public:
  virtual ~FrameAssembly() = default;
  virtual const SourceInfo& info() const = 0;
  /// Goes to the next frame and gives its stamp; empty at the end.
  virtual std::optional<std::int64_t> advance(SkipLog& skips) = 0;
  /// Decodes the frame gone to; empty when it cannot be used.
  virtual std::optional<SourceFrame> decode(SkipLog& skips) = 0;
  virtual geometry::Trajectory groundtruth() const = 0;
};

/// Fills in how many frames a topic promises and their nominal rate, the median of the first.
void describe_rate(Recording& recording, const std::string& topic, SourceInfo& info);

/// The user's parameters for a recording.
struct RecordingOptions {
  ImageTopics topics;
  std::string calibration_file;  ///< replaces the recording's calibration and depth unit
};

/// Frames from two topics of ROS images, one of their calibration and, where the recording has them, transforms.
/// Throws SourceError: topics, encodings, calibration. `recording` outlives the result.
std::unique_ptr<FrameAssembly> make_image_pairs(Recording& recording, const RecordingOptions& options);

/// The topic with frames that our own recorder took from rtd/frame; empty when there is none.
std::string own_frames_topic(const Recording& recording);
/// Frames from that topic. Throws SourceError when none can be used. `recording` outlives the result.
std::unique_ptr<FrameAssembly> make_own_frames(Recording& recording);

/// Plays a recording. Opening reads the first good frame. Throws SourceError: topics, calibration, no good frame.
class RecordingSource final : public FrameSource {
 public:
  RecordingSource(std::string uri, std::unique_ptr<Recording> recording, const RecordingOptions& options);

  std::optional<SourceFrame> next() override;
  std::uint64_t pass_over(std::int64_t stamp_ns) override;
  const SourceInfo& info() const override { return info_; }
  const SourceCounters& counters() const override { return skips_.counters(); }
  /// Of what was played so far.
  geometry::Trajectory groundtruth() const override { return frames_->groundtruth(); }
  std::vector<SkippedInput> take_skipped() override { return skips_.take(); }

 private:
  std::optional<SourceFrame> read_next();
  void take_damages();

  SourceInfo info_;
  SkipLog skips_;
  std::unique_ptr<Recording> recording_;
  std::unique_ptr<FrameAssembly> frames_;
  std::optional<std::int64_t> gone_to_;  ///< stamp of the current frame of frames_, not decoded yet
  std::optional<SourceFrame> first_;     ///< read while opening
};

}  // namespace rtd::camera
