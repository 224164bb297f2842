// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/other_format_report.hpp"

#include <algorithm>
#include <fstream>
#include <memory>

#include "common/camera/recording/recording.hpp"
#include "common/io/recording_forms.hpp"

namespace rtd::recordings {
namespace {

struct OtherFormat {
  std::string_view begin;
  std::string name;
  std::unique_ptr<camera::Recording> (*open)(const std::filesystem::path&);
};

const OtherFormat* format_of(const std::filesystem::path& file) {
  static const std::array<OtherFormat, 2> kFormats = {OtherFormat{io::kBagMagic, "ROS 1 bag", camera::open_bag},
                                                      OtherFormat{io::kDb3Magic, "rosbag2 sqlite3", camera::open_db3}};
  std::string begin(io::kMagicBytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  const auto found =
      std::ranges::find_if(kFormats, [&](const auto& format) { return begin.starts_with(format.begin); });
  return found == kFormats.end() ? nullptr : &*found;
}

struct Channel {
  std::vector<mcap::Timestamp> times_ns;
  std::uint64_t bytes = 0;
};

std::map<std::string, Channel> read_all(camera::Recording& recording) {
  std::map<std::string, Channel> channels;
  std::vector<std::string> names;
  for (const camera::RecordedTopic& topic : recording.topics()) {
    channels.try_emplace(topic.name);
    names.push_back(topic.name);
  }
  recording.play(names);
  while (const std::optional<camera::RecordedMessage> message = recording.next()) {
    Channel& channel = channels[message->topic];
    channel.times_ns.push_back(static_cast<mcap::Timestamp>(std::max<std::int64_t>(0, message->recorded_ns)));
    channel.bytes += message->bytes.size();
  }
  return channels;
}

void add_channel(RecordingReport& report, const std::string& topic, const std::string& type, const Channel& read) {
  ChannelReport channel;
  channel.channel.topic = topic;
  channel.type = type;
  channel.timing = timing_of(read.times_ns);
  channel.payload_bytes = read.bytes;
  if (channel.timing.messages > 0) {
    report.start_ns =
        report.messages == 0 ? channel.timing.first_ns : std::min(report.start_ns, channel.timing.first_ns);
    report.end_ns = std::max(report.end_ns, channel.timing.last_ns);
  }
  report.messages += channel.timing.messages;
  report.channels.push_back(std::move(channel));
}

}  // namespace

std::optional<RecordingReport> report_on_other_format(const std::filesystem::path& file) {
  const OtherFormat* const format = format_of(file);
  if (format == nullptr) return std::nullopt;
  const std::unique_ptr<camera::Recording> recording = format->open(file);
  RecordingReport report;
  report.format = format->name;
  report.file_bytes = std::filesystem::file_size(file);
  report.read_all = true;
  const std::map<std::string, Channel> channels = read_all(*recording);
  std::map<std::string, std::string> types;
  for (const camera::RecordedTopic& topic : recording->topics()) types[topic.name] = topic.type;
  for (const auto& [topic, channel] : channels) add_channel(report, topic, types[topic], channel);
  for (const std::string& damage : recording->take_damages()) {
    ++report.problem_count;
    report.data_lost = true;
    report.problems.push_back({mcap::ProblemKind::kDamagedRecord, 0, damage, "it is left out", true});
  }
  return report;
}

}  // namespace rtd::recordings
