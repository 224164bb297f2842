// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rtd::bus {

/// Who writes and who reads a topic, by the names of services ("filter"). Keystores are made from it, a test
/// compares it with what the running services open.
struct TopicRoles {
  std::string topic;  ///< DDS name, or a pattern of names ("rt/*")
  std::vector<std::string_view> writers, readers;
};
const std::vector<TopicRoles>& topic_roles();

/// All roles: services, launcher, `rtd topics`, `rtd call`, observer (ROS 2 and other programs that read poses).
const std::vector<std::string>& roles();

/// The topics of one role.
struct RoleTopics {
  std::vector<std::string> writes, reads;
};
RoleTopics topics_of(const std::string& role);

}  // namespace rtd::bus
