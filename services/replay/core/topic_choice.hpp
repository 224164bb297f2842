// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/mcap/records.hpp"

namespace rtd::replay {

/// Whether the messages of a channel can be sent over DDS as they are; others ("json", "protobuf", "ros1") would arrive
/// as garbage under their type's name.
bool is_cdr(const mcap::Channel& channel);
/// Its message encoding, for messages; "none" if it has none.
std::string encoding_of(const mcap::Channel& channel);

/// Whether the services of a run publish this topic (DDS name) for each other or as their result: a replay of it would
/// mix with a run in the same domain. rt/tf, rt/diagnostics and rt/camera/* belong to everyone.
bool is_run_topic(const std::string& dds_topic);

/// Which topics of a recording are played. Patterns are those of a shell ("/slam/*") and meet the name in the recording
/// as well as the DDS name ("/slam/pose", "rt/slam/pose"), and for a robot with a name also that without it.
class TopicChoice {
 public:
  /// No pattern in `wanted`: all but those of `excluded` and rtd/status, whose replay would make running services exit
  /// as duplicates of the recorded ones.
  TopicChoice(std::vector<std::string> wanted, std::vector<std::string> excluded)
      : wanted_(std::move(wanted)), excluded_(std::move(excluded)) {}

  bool wants(const std::string& topic) const;
  /// The patterns that meet none of these topics.
  std::vector<std::string> unmet(const std::vector<std::string>& topics) const;

 private:
  std::vector<std::string> wanted_, excluded_;
};

/// New names by old ones, both as DDS has them, from "old:=new" in either spelling. Throws service::ConfigError: no
/// ":=", an empty name, white space in one, two new names for one topic.
std::map<std::string, std::string> parse_remaps(const std::vector<std::string>& texts);

}  // namespace rtd::replay
