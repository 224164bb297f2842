// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/report_text.hpp"

namespace rtd::recording {
namespace {

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

Json sequence_json(const std::optional<SequenceCount>& sequences) {
  if (!sequences || !sequences->numbered()) return nullptr;
  const std::optional<std::uint64_t> missing = sequences->missing();
  return {
      {"missing", missing ? Json(*missing) : Json()}, {"gaps", sequences->gaps()}, {"restarts", sequences->restarts()}};
}

Json channel_json(const ChannelReport& entry) {
  Json json = {{"topic", entry.channel.topic},
               {"id", entry.channel.id},
               {"type", entry.type},
               {"message_encoding", entry.channel.message_encoding},
               {"schema_encoding", entry.schema_encoding},
               {"schema_text", entry.schema_text},
               {"metadata", entry.channel.metadata}};
  json.update(timing_json(entry.timing));
  json["payload_bytes"] = entry.payload_bytes ? Json(*entry.payload_bytes) : Json(nullptr);
  json["sequence"] = sequence_json(entry.sequences);
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

}  // namespace

Json to_json(const mcap::Problem& problem) {
  return {{"kind", mcap::name_of(problem.kind)}, {"offset", problem.offset},       {"what", problem.what},
          {"consequence", problem.consequence},  {"data_lost", problem.data_lost}, {"count", problem.count}};
}

Json to_json(const RecordingReport& report, const std::string& name) {
  Json json = {{"file", name},
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
  for (const ChannelReport& channel : report.channels) json["topics"].push_back(channel_json(channel));
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

}  // namespace rtd::recording
