// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::recorder {

/// Which topics are recorded: shell patterns (* ? [a-z], a star also crosses slashes) on the DDS name or the ROS 2
/// name.
class TopicFilter {
 public:
  explicit TopicFilter(std::vector<std::string> patterns) : patterns_(std::move(patterns)) {}
  bool wants(const std::string& dds_topic) const;

 private:
  std::vector<std::string> patterns_;
};

}  // namespace rtd::recorder
