// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/recording.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/ros2/offered_qos.hpp"

namespace rtd::recorder {
namespace {

/// A double-quoted YAML scalar.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
    } else {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out + '"';
}

std::string span_text(const char* indent, const FileSummary& span) {
  return fmt::format(
      "{0}duration:\n{0}  nanoseconds: {1}\n{0}starting_time:\n{0}  nanoseconds_since_epoch: {2}\n"
      "{0}message_count: {3}\n",
      indent, span.last_ns - span.first_ns, span.first_ns, span.messages);
}

FileSummary sum(const std::vector<FileSummary>& files) {
  FileSummary all;
  for (const FileSummary& file : files) {
    if (file.messages == 0) continue;
    all.first_ns = all.messages == 0 ? file.first_ns : std::min(all.first_ns, file.first_ns);
    all.last_ns = std::max(all.last_ns, file.last_ns);
    all.messages += file.messages;
    all.bytes += file.bytes;
  }
  return all;
}

std::string topic_text(const RecordedTopic& topic) {
  return fmt::format(
      "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n"
      "        offered_qos_profiles: {}\n      message_count: {}\n",
      quoted(topic.name), quoted(topic.type.name), quoted(ros2::offered_qos_text(topic.offered)), topic.counts.written);
}

}  // namespace

std::string bag_metadata_text(const std::vector<std::string>& names, const std::vector<FileSummary>& files,
                              const std::vector<RecordedTopic>& topics) {
  std::string text = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n";
  text += span_text("  ", sum(files));
  text += topics.empty() ? "  topics_with_message_count: []\n" : "  topics_with_message_count:\n";
  for (const RecordedTopic& topic : topics) text += topic_text(topic);
  text += "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n";
  for (const std::string& name : names) text += "    - " + name + '\n';
  text += "  files:\n";
  for (std::size_t i = 0; i < files.size(); ++i) {
    text += "    - path: " + names[i] + '\n' + span_text("      ", files[i]);
  }
  return text;
}

}  // namespace rtd::recorder
