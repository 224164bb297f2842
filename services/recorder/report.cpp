// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace rtd::recorder {
namespace {

nlohmann::json to_json(const RecordedTopic& topic) {
  return {{"name", topic.name},
          {"type", topic.type.name},
          {"definition", topic.type.encoding},
          {"messages", topic.counts.written},
          {"bytes", topic.counts.written_bytes},
          {"acknowledged", topic.counts.acknowledged},
          {"lost_in_transit", topic.counts.lost_in_transit},
          {"lost_in_queue", topic.counts.lost_in_queue}};
}

std::string size_text(std::uint64_t bytes) {
  const double megabytes = static_cast<double>(bytes) * 1e-6;
  return megabytes < 10'000 ? fmt::format("{:.1f} MB", megabytes) : fmt::format("{:.1f} GB", megabytes * 1e-3);
}

}  // namespace

bool RecordingReport::partial() const {
  const bool lost =
      std::any_of(topics.begin(), topics.end(), [](const auto& topic) { return topic.counts.lost() > 0; });
  return lost || !failure.empty();
}

std::string report_json(const RecordingReport& report) {
  nlohmann::json out{{"folder", report.folder},
                     {"duration_s", report.duration_s},
                     {"acknowledged_bytes", report.acknowledged_bytes},
                     {"partial", report.partial()},
                     {"failure", report.failure},
                     {"messages", 0},
                     {"lost", 0},
                     {"bytes", 0},
                     {"files", nlohmann::json::array()},
                     {"topics", nlohmann::json::array()}};
  std::uint64_t messages = 0, lost = 0, bytes = 0;
  for (const RecordedTopic& topic : report.topics) {
    out["topics"].push_back(to_json(topic));
    messages += topic.counts.written;
    lost += topic.counts.lost();
  }
  for (std::size_t i = 0; i < report.files.size(); ++i) {
    const FileSummary& file = report.files[i];
    out["files"].push_back({{"name", report.names[i]}, {"bytes", file.bytes}, {"messages", file.messages}});
    bytes += file.bytes;
  }
  out["messages"] = messages;
  out["lost"] = lost;
  out["bytes"] = bytes;
  return out.dump(2);
}

mcap::Metadata loss_metadata(const std::vector<RecordedTopic>& topics) {
  mcap::Metadata record{"rtd:losses", {}};
  std::uint64_t total = 0;
  for (const RecordedTopic& topic : topics) {
    total += topic.counts.lost();
    if (topic.counts.lost() == 0) continue;
    record.metadata[topic.name] =
        fmt::format("in_transit={} in_queue={}", topic.counts.lost_in_transit, topic.counts.lost_in_queue);
  }
  record.metadata["total"] = std::to_string(total);
  return record;
}

std::string progress_text(const ProgressFacts& facts) {
  return fmt::format("recording {:.0f} s  {} messages  {}/s  {}  lost {}  free {}", facts.elapsed_s,
                     facts.totals.written, size_text(static_cast<std::uint64_t>(facts.bytes_per_s)),
                     size_text(facts.file_bytes), facts.totals.lost(), size_text(facts.free_bytes));
}

}  // namespace rtd::recorder
