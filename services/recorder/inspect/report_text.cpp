// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "common/service/command_line.hpp"
#include "services/recorder/inspect/recording_report.hpp"

namespace rtd::recordings {
namespace {

constexpr std::size_t kShownProblems = 10;

std::string head_row(const char* name, const std::string& text) {
  return text.empty() ? "" : fmt::format("{:<12} {}\n", name, text);
}

std::string time_row(const RecordingReport& report) {
  if (report.messages == 0) return head_row("time", "no messages");
  return head_row("time", fmt::format("{} for {}", service::time_text(report.start_ns),
                                      service::seconds_text(report.end_ns - report.start_ns)));
}

std::string chunk_rows(const RecordingReport& report) {
  std::string text;
  for (const auto& [compression, chunks] : report.chunks) {
    const double ratio =
        static_cast<double>(chunks.bytes) / static_cast<double>(std::max<std::uint64_t>(1, chunks.uncompressed_bytes));
    text += head_row(
        "chunks",
        fmt::format("{} {}, {}{}", chunks.chunks, compression.empty() ? "not compressed" : compression,
                    service::bytes_text(chunks.bytes),
                    compression.empty() ? ""
                                        : fmt::format(" of {} ({:.0f} %)",
                                                      service::bytes_text(chunks.uncompressed_bytes), 100 * ratio)));
  }
  return text;
}

std::string summary_row(const RecordingReport& report) {
  if (report.being_written) return head_row("summary", "not yet: the file is still being written");
  return head_row("summary", report.has_summary ? "present" : "missing or unusable: the file was read from the start");
}

std::string metadata_rows(const RecordingReport& report) {
  std::string text;
  for (const mcap::Metadata& metadata : report.metadata) {
    if (metadata.metadata == report.losses()) continue;  // has its own rows
    std::string values;
    for (const auto& [key, value] : metadata.metadata)
      values += fmt::format("{}{}={}", values.empty() ? "" : ", ", key, value);
    constexpr std::size_t kLongest = 200;
    if (values.size() > kLongest) values = values.substr(0, kLongest) + "... (--json shows all)";
    text += head_row("metadata", metadata.name + ": " + values);
  }
  for (const mcap::AttachmentIndex& attachment : report.attachments)
    text += head_row("attachment", fmt::format("{} ({}), {}", attachment.name, attachment.media_type,
                                               service::bytes_text(attachment.data_size)));
  return text;
}

/// The losses that the recorder reports.
std::string loss_rows(const RecordingReport& report) {
  std::string text;
  for (const auto& [topic, lost] : report.losses()) {
    if (topic == "total") continue;
    text += head_row("lost", topic + ": " + lost);
  }
  if (text.empty() && !report.losses().empty()) text = head_row("lost", "nothing, according to the recorder");
  return text;
}

std::string missing_text(const RecordingReport& report, const ChannelReport& channel) {
  if (report.missing_in_shared_counter || !channel.sequences || !channel.sequences->numbered()) return "-";
  const std::optional<std::uint64_t> missing = channel.sequences->missing();
  return missing ? std::to_string(*missing) : "-";
}

std::string channel_row(const RecordingReport& report, const ChannelReport& channel, std::size_t topic_width,
                        std::size_t type_width) {
  const Timing& timing = channel.timing;
  return fmt::format("{:<{}} {:<{}} {:>8} {:>9.2f} {:>10.1f} {:>10.1f} {:>5} {:>6} {:>9}\n", channel.channel.topic,
                     topic_width, channel.type.empty() ? "(no schema)" : channel.type, type_width, timing.messages,
                     timing.rate_hz, static_cast<double>(timing.median_period_ns) * 1e-6,
                     static_cast<double>(timing.largest_gap_ns) * 1e-6, timing.gaps, missing_text(report, channel),
                     channel.payload_bytes ? service::bytes_text(*channel.payload_bytes) : "-");
}

std::string channel_table(const RecordingReport& report) {
  if (report.channels.empty()) return "";
  std::size_t topic_width = 5, type_width = 11;
  for (const ChannelReport& channel : report.channels) {
    topic_width = std::max(topic_width, channel.channel.topic.size());
    type_width = std::max(type_width, channel.type.size());
  }
  std::string text =
      fmt::format("\n{:<{}} {:<{}} {:>8} {:>9} {:>10} {:>10} {:>5} {:>6} {:>9}\n", "topic", topic_width, "type",
                  type_width, "messages", "rate Hz", "median ms", "longest ms", "gaps", "lost", "size");
  for (const ChannelReport& channel : report.channels) text += channel_row(report, channel, topic_width, type_width);
  if (report.missing_in_shared_counter)
    return text +
           fmt::format("gaps: periods above {} medians; lost: {} of the sequence numbers that all topics share\n",
                       kGapPeriods, *report.missing_in_shared_counter);
  return text +
         fmt::format("gaps: periods above {} medians; lost: missing sequence numbers, - with several writers{}\n",
                     kGapPeriods, report.read_all ? "" : " (--check counts them)");
}

using Json = nlohmann::ordered_json;

double seconds(std::uint64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

Json timing_json(const Timing& timing) {
  return {{"messages", timing.messages},
          {"first_ns", timing.first_ns},
          {"last_ns", timing.last_ns},
          {"rate_hz", timing.rate_hz},
          {"median_period_s", seconds(timing.median_period_ns)},
          {"largest_gap_s", seconds(timing.largest_gap_ns)},
          {"largest_gap_at_ns", timing.largest_gap_at_ns},
          {"gaps", timing.gaps}};
}

/// Of a counter that the channel has for itself.
Json sequence_json(const RecordingReport& report, const std::optional<SequenceCount>& sequences) {
  if (report.missing_in_shared_counter || !sequences || !sequences->numbered()) return nullptr;
  const std::optional<std::uint64_t> missing = sequences->missing();
  return {
      {"missing", missing ? Json(*missing) : Json()}, {"gaps", sequences->gaps()}, {"restarts", sequences->restarts()}};
}

Json channel_json(const RecordingReport& report, const ChannelReport& entry) {
  Json json = {{"topic", entry.channel.topic},
               {"id", entry.channel.id},
               {"type", entry.type},
               {"message_encoding", entry.channel.message_encoding},
               {"schema_encoding", entry.schema_encoding},
               {"schema_text", entry.schema_text},
               {"metadata", entry.channel.metadata}};
  json.update(timing_json(entry.timing));
  json["payload_bytes"] = entry.payload_bytes ? Json(*entry.payload_bytes) : Json(nullptr);
  json["sequence"] = sequence_json(report, entry.sequences);
  return json;
}

Json chunks_json(const RecordingReport& report) {
  Json chunks = Json::array();
  for (const auto& [compression, of_one] : report.chunks)
    chunks.push_back({{"compression", compression},
                      {"count", of_one.chunks},
                      {"bytes", of_one.bytes},
                      {"uncompressed_bytes", of_one.uncompressed_bytes}});
  return chunks;
}

Json to_json(const mcap::Problem& problem) {
  return {{"kind", mcap::name_of(problem.kind)}, {"offset", problem.offset},       {"what", problem.what},
          {"consequence", problem.consequence},  {"data_lost", problem.data_lost}, {"count", problem.count}};
}

}  // namespace

std::string checksum_text(const RecordingReport& report) {
  if (!report.read_all) return "right in the summary; --check reads the rest";
  std::uint64_t chunks = 0, without = 0;
  for (const auto& [compression, of_one] : report.chunks) {
    chunks += of_one.chunks;
    without += of_one.without_crc;
  }
  const auto wrong = std::ranges::count(report.problems, mcap::ProblemKind::kCrcMismatch, &mcap::Problem::kind);
  if (wrong > 0) return fmt::format("{} WRONG, see below", wrong);
  return fmt::format("all right, {} chunks{}", chunks,
                     without > 0 ? fmt::format(", {} of them without a checksum", without) : "");
}

std::string problems_text(const std::vector<mcap::Problem>& problems, std::uint64_t count, std::size_t most) {
  if (problems.empty()) return "";
  std::string text = fmt::format("\n{} problem{}:\n", count, count == 1 ? "" : "s");
  for (std::size_t i = 0; i < std::min(problems.size(), most); ++i) text += "  " + mcap::to_string(problems[i]) + "\n";
  if (problems.size() > most) text += fmt::format("  ... and more (--json lists {})\n", problems.size());
  return text;
}

std::string to_text(const RecordingReport& report, const std::string& name) {
  const std::string profile = report.header.profile.empty() ? "" : ", profile " + report.header.profile;
  const std::string library = report.header.library.empty() ? "" : ", written by " + report.header.library;
  const bool other_format = report.format != RecordingReport().format;
  const std::string format = other_format ? ", " + report.format : "";
  std::string text = head_row(
      "file", fmt::format("{}, {}{}{}{}", name, service::bytes_text(report.file_bytes), format, profile, library));
  text += time_row(report);
  text += head_row("messages", fmt::format("{} on {} topics", report.messages, report.channels.size()));
  if (!other_format) text += chunk_rows(report) + summary_row(report) + head_row("checksums", checksum_text(report));
  return text + loss_rows(report) + metadata_rows(report) + channel_table(report) +
         problems_text(report.problems, report.problem_count, kShownProblems);
}

Json to_json(const RecordingReport& report, const std::string& name) {
  Json json = {{"file", name},
               {"format", report.format},
               {"bytes", report.file_bytes},
               {"profile", report.header.profile},
               {"library", report.header.library},
               {"being_written", report.being_written},
               {"has_summary", report.has_summary},
               {"read_all", report.read_all},
               {"damaged", report.damaged()},
               {"checksums", checksum_text(report)},
               {"messages", report.messages},
               {"start_ns", report.start_ns},
               {"end_ns", report.end_ns},
               {"duration_s", seconds(report.end_ns - report.start_ns)},
               {"chunks", chunks_json(report)}};
  json["topics"] = Json::array();
  for (const ChannelReport& channel : report.channels) json["topics"].push_back(channel_json(report, channel));
  const auto& shared = report.missing_in_shared_counter;
  json["shared_sequence"] = shared ? Json{{"missing", *shared}} : Json(nullptr);
  json["losses"] = report.losses().empty() ? Json(nullptr) : Json(report.losses());
  json["metadata"] = Json::array();
  for (const mcap::Metadata& metadata : report.metadata)
    json["metadata"].push_back({{"name", metadata.name}, {"values", metadata.metadata}});
  json["attachments"] = Json::array();
  for (const mcap::AttachmentIndex& attachment : report.attachments)
    json["attachments"].push_back(
        {{"name", attachment.name}, {"media_type", attachment.media_type}, {"bytes", attachment.data_size}});
  json["problem_count"] = report.problem_count;
  json["problems"] = Json::array();
  for (const mcap::Problem& problem : report.problems) json["problems"].push_back(to_json(problem));
  return json;
}

}  // namespace rtd::recordings
