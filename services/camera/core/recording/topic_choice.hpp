// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/camera/core/recording/recording.hpp"

namespace rtd::camera {

/// The topics that make RGB-D frames. As options: what the user named, else empty.
struct ImageTopics {
  std::string color, depth, info;
};

/// Completes what the user named: by the names that TUM, the OpenNI and RealSense drivers and we ourselves give, else
/// the only topic of a fitting type; the calibration is the one beside the colour image. `info` stays empty when there
/// is none. Throws SourceError for a topic that is absent, of another type or ambiguous, listing the
/// topics there are.
ImageTopics choose_topics(const Recording& recording, const ImageTopics& named);

/// Whether the name is one that drivers give to depth registered to colour only.
bool named_as_registered(const std::string& depth_topic);

/// Null when there is none of this name.
const RecordedTopic* topic_named(const Recording& recording, const std::string& name);

/// The topics of type tf.
std::vector<std::string> transform_topics(const Recording& recording);

/// "  /camera/rgb/image_color (sensor_msgs/Image, 798 messages)", a line each: for messages.
std::string list_topics(const Recording& recording);

}  // namespace rtd::camera
