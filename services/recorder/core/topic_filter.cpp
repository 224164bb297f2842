// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/topic_filter.hpp"

#include <fnmatch.h>

#include <algorithm>

#include "common/ros2/names.hpp"

namespace rtd::recorder {

bool TopicFilter::wants(const std::string& dds_topic) const {
  const std::string ros_topic = ros2::ros_topic(dds_topic);
  return std::any_of(patterns_.begin(), patterns_.end(), [&](const std::string& pattern) {
    return fnmatch(pattern.c_str(), dds_topic.c_str(), 0) == 0 || fnmatch(pattern.c_str(), ros_topic.c_str(), 0) == 0;
  });
}

}  // namespace rtd::recorder
