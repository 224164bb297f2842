// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/recordings/reader.hpp"

/// What of a recording makes RGB-D frames.
namespace rtd::camera {

using recordings::plain_type, recordings::RecordedMessage, recordings::RecordedTopic;

/// The first message of a topic. Throws SourceError when there is none that can be read.
RecordedMessage first_of(recordings::Reader& recording, const std::string& topic);

/// The topics that make RGB-D frames. As options: what the user named, else empty.
struct ImageTopics {
  std::string color, depth, info, depth_info;
};

/// Completes what the user named: by the names that known drivers give (driver_topics.hpp), else the only topic of a
/// fitting type; the calibrations are those beside the images. `info` and `depth_info` stay empty
/// when there is none. Throws SourceError for a topic that is absent, of another type or ambiguous, listing the
/// topics there are.
ImageTopics choose_topics(const recordings::Reader& recording, const ImageTopics& named);

/// The topics of type tf.
std::vector<std::string> transform_topics(const recordings::Reader& recording);

}  // namespace rtd::camera
