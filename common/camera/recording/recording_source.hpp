// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "common/camera/calibration_request.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/recording/recording.hpp"

namespace rtd::camera {

/// The user's parameters for a recording.
struct RecordingOptions {
  ImageTopics topics;
  CalibrationRequest calibration;                   ///< replaces the recording's, and its depth unit where it has one
  bool registered = false;                          ///< depth is registered to colour, whatever it looks like
  std::int64_t tolerance_ns = kPairingToleranceNs;  ///< between the stamps of colour and depth
};

/// Plays a recording: the frames that our own recorder took from rtd/frame, unless topics are named, else frames from
/// two topics of ROS images. Opening reads the first good frame. Throws SourceError: topics, encodings, calibration, no
/// good frame.
std::unique_ptr<FrameSource> open_recording(std::string uri, std::unique_ptr<recordings::Reader> recording,
                                            const RecordingOptions& options);

/// What the kinds of recorded frames share.
class RecordingSource : public PlayedSource {
 protected:
  RecordingSource(std::string uri, std::unique_ptr<recordings::Reader> recording);
  /// Fills in how many frames a topic promises and their nominal rate, the median of the first.
  void describe_rate(const std::string& topic);
  /// Counts what was found damaged since the last call.
  void take_damages();

  const std::unique_ptr<recordings::Reader> recording_;
};

/// Frames from two topics of ROS images, one of their calibration and, where the recording has them, transforms.
std::unique_ptr<FrameSource> make_image_pairs(std::string uri, std::unique_ptr<recordings::Reader> recording,
                                              const RecordingOptions& options);

/// The topic with frames that our own recorder took from rtd/frame; empty when there is none.
std::string own_frames_topic(const recordings::Reader& recording);
/// Frames from that topic.
std::unique_ptr<FrameSource> make_own_frames(std::string uri, std::unique_ptr<recordings::Reader> recording);

}  // namespace rtd::camera
