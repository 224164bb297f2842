// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/recordings/reader.hpp"

/// What of a recording makes RGB-D frames.
namespace rtd::camera {

/// Two topics that make frames.
struct TopicPair {
  std::string color, depth;
};

/// The pairs that the best known driver makes of these topics: colour and depth behind the same names of camera and
/// namespace, raw images before compressed ones, depth registered to colour before depth that is not. One element: the
/// choice is clear; several: that many cameras; none: the names are not those of a driver in the table of
/// recording.cpp (TUM, OpenNI, Orbbec and its SDK, RealSense in ROS 1 and 2 and its SDK, OAK, Azure Kinect, Kinect v2,
/// ZED).
std::vector<TopicPair> driver_pairs(const std::vector<std::string>& color, const std::vector<std::string>& depth);

/// Whether a driver gives this name to depth, or the name says so itself.
bool named_as_depth(const std::string& topic);

/// Whether the name is that of images without colour, of depth or of masks.
bool named_as_other_than_color(const std::string& topic);

/// Whether a driver gives this name to the left infrared camera of a stereo pair, or to the only one.
bool named_as_infrared(const std::string& topic);

/// The topic at which the RealSense SDK records the unit of a depth topic; empty for topics of others.
std::string sdk_depth_unit_topic(const std::string& depth_topic);

using recordings::plain_type, recordings::RecordedMessage, recordings::RecordedTopic;

/// The first message of a topic. Throws SourceError when there is none that can be read.
RecordedMessage first_of(recordings::Reader& recording, const std::string& topic);

/// The topics that make RGB-D frames. As options: what the user named, else empty.
struct ImageTopics {
  std::string color, depth, info, depth_info;
};

/// Completes what the user named: by the names that known drivers give (driver_pairs()), else the only topic of a
/// fitting type; the calibrations are those next to the images. `info` and `depth_info` stay empty
/// when there is none. Throws SourceError for a topic that is absent, of another type or ambiguous, listing the
/// topics there are.
ImageTopics choose_topics(const recordings::Reader& recording, const ImageTopics& named);

/// The topics of type tf.
std::vector<std::string> transform_topics(const recordings::Reader& recording);

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
