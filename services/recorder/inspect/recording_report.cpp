// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_report.hpp"

#include <algorithm>

#include "common/mcap/codec.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/stream_reader.hpp"

namespace rtd::recordings {
namespace {

using mcap::ChannelId;
using mcap::Timestamp;

/// What is read before it becomes a report.
struct PerChannel {
  std::vector<Timestamp> times_ns;
  std::uint64_t payload_bytes = 0;
  SequenceCount sequences;
  std::vector<std::uint32_t> numbers;  ///< what it has counted
};
using Collected = std::map<ChannelId, PerChannel>;

void take(RecordingReport& report, const mcap::Problems& problems) {
  report.problems = problems.listed();
  report.problem_count = problems.total();
  report.data_lost = problems.data_lost();
}

std::optional<std::uint64_t> missing_in_all(Collected& collected) {
  std::vector<std::vector<std::uint32_t>> of_channels;
  for (auto& [id, channel] : collected)
    if (channel.sequences.numbered()) of_channels.push_back(std::move(channel.numbers));
  return missing_of_shared_counter(of_channels);
}

/// Adds the channels once their definitions and times are known.
void add_channels(RecordingReport& report, Collected& collected, const std::map<ChannelId, mcap::Channel>& channels,
                  const std::map<mcap::SchemaId, mcap::Schema>& schemas) {
  for (const auto& [id, channel] : channels) {
    ChannelReport entry{channel, {}, {}, false, {}, {}, {}};
    if (const auto schema = schemas.find(channel.schema_id); schema != schemas.end()) {
      entry.type = schema->second.name;
      entry.schema_encoding = schema->second.encoding;
      entry.schema_text = !schema->second.data.empty();
    }
    PerChannel& read = collected[id];
    if (report.read_all) {
      entry.payload_bytes = read.payload_bytes;
      entry.sequences = read.sequences;
    }
    entry.timing = timing_of(std::move(read.times_ns));
    report.channels.push_back(std::move(entry));
  }
  std::ranges::stable_sort(report.channels, {}, [](const ChannelReport& entry) { return entry.channel.topic; });
  report.count_messages();
}

void add_chunk(RecordingReport& report, const std::string& compression, std::uint64_t bytes, std::uint64_t uncompressed,
               bool has_crc) {
  ChunkReport& chunks = report.chunks[compression];
  ++chunks.chunks;
  chunks.bytes += bytes;
  chunks.uncompressed_bytes += uncompressed;
  chunks.without_crc += has_crc ? 0 : 1;
}

/// The times of the messages of one chunk, from the indexes after it; false when these cannot be read.
bool read_index(const io::ByteSource& source, const mcap::ChunkIndex& chunk, Collected& collected) {
  const std::uint64_t offset = chunk.chunk_start_offset + chunk.chunk_length;
  if (offset > source.size() || chunk.message_index_length > source.size() - offset) return false;
  std::vector<std::byte> bytes(chunk.message_index_length);
  if (source.read(offset, bytes) != bytes.size()) return false;
  mcap::RecordCursor records(bytes);
  while (const std::optional<mcap::InnerRecord> record = records.next()) {
    const auto index = mcap::decode<mcap::MessageIndex>(record->content);
    if (record->opcode != mcap::Opcode::kMessageIndex || !index) return false;
    std::vector<Timestamp>& times_ns = collected[index->channel_id].times_ns;
    for (const auto& [log_time, position] : index->records) times_ns.push_back(log_time);
  }
  return !records.cut();
}

/// False when the indexes do not cover every message: then the file has to be read.
bool report_from_summary(const io::ByteSource& source, RecordingReport& report) {
  mcap::IndexedReader reader(source);
  const mcap::Summary& summary = reader.summary();
  if (summary.scanned || !summary.statistics) return false;
  Collected collected;
  for (const mcap::ChunkIndex& chunk : summary.chunk_indexes) {
    if (!read_index(source, chunk, collected)) return false;
    add_chunk(report, chunk.compression, chunk.compressed_size, chunk.uncompressed_size, true);
  }
  add_channels(report, collected, summary.channels, summary.schemas);
  if (report.messages != summary.statistics->message_count) return false;
  report.has_summary = true;
  report.header = summary.header;
  report.attachments = summary.attachment_indexes;
  for (const mcap::MetadataIndex& index : summary.metadata_indexes)
    if (const std::optional<mcap::Metadata> metadata = reader.metadata(index)) report.metadata.push_back(*metadata);
  take(report, reader.problems());
  return true;
}

/// One record of a file that is read from the start.
void add_record(RecordingReport& report, Collected& collected, const mcap::Record& record, std::uint64_t offset) {
  if (const auto* message = std::get_if<mcap::Message>(&record)) {
    PerChannel& channel = collected[message->channel_id];
    channel.times_ns.push_back(message->log_time);
    channel.payload_bytes += message->data.size();
    channel.sequences.add(message->sequence);
    channel.numbers.push_back(message->sequence);
  } else if (const auto* chunk = std::get_if<mcap::Chunk>(&record)) {
    add_chunk(report, chunk->compression, chunk->records.size(), chunk->uncompressed_size,
              chunk->uncompressed_crc != 0 || chunk->uncompressed_size == 0);
  } else if (const auto* header = std::get_if<mcap::Header>(&record)) {
    report.header = *header;
  } else if (const auto* metadata = std::get_if<mcap::Metadata>(&record)) {
    report.metadata.push_back(*metadata);
  } else if (const auto* attachment = std::get_if<mcap::Attachment>(&record)) {
    report.attachments.push_back({offset, 0, attachment->log_time, attachment->create_time, attachment->data.size(),
                                  attachment->name, attachment->media_type});
  }
}

void report_from_everything(const io::ByteSource& source, const ReportOptions& options, RecordingReport& report) {
  mcap::Problems ignored(0);  // the reader below finds the same problems
  const std::optional<mcap::Summary> summary = mcap::read_summary(source, {}, ignored);
  mcap::StreamReader reader(source);
  if (summary) reader.assume(summary->schemas, summary->channels);
  report.has_summary = summary.has_value();
  report.read_all = true;
  Collected collected;
  while (const mcap::Record* record = reader.next()) {
    add_record(report, collected, *record, reader.location().record.offset);
    if (options.on_progress) options.on_progress(reader.bytes_read());
  }
  report.missing_in_shared_counter = missing_in_all(collected);
  add_channels(report, collected, reader.channels(), reader.schemas());
  take(report, reader.problems());
}

bool is_damage(const mcap::Problem& problem, bool being_written) {
  return mcap::is_damage(problem) && (problem.kind != mcap::ProblemKind::kTruncated || !being_written);
}

}  // namespace

Timing timing_of(std::vector<mcap::Timestamp> times_ns) {
  Timing timing;
  timing.messages = times_ns.size();
  if (times_ns.empty()) return timing;
  std::ranges::sort(times_ns);
  timing.first_ns = times_ns.front();
  timing.last_ns = times_ns.back();
  std::vector<std::uint64_t> periods_ns;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    periods_ns.push_back(times_ns[i] - times_ns[i - 1]);
    if (periods_ns.back() <= timing.largest_gap_ns) continue;
    timing.largest_gap_ns = periods_ns.back();
    timing.largest_gap_at_ns = times_ns[i - 1];
  }
  if (timing.first_ns == timing.last_ns) return timing;
  timing.rate_hz = static_cast<double>(periods_ns.size()) * 1e9 / static_cast<double>(timing.last_ns - timing.first_ns);
  const auto middle = periods_ns.begin() + static_cast<std::ptrdiff_t>(periods_ns.size() / 2);
  std::ranges::nth_element(periods_ns, middle);
  timing.median_period_ns = *middle;
  const double longest_ns = kGapPeriods * static_cast<double>(timing.median_period_ns);
  timing.gaps = static_cast<std::uint64_t>(std::ranges::count_if(
      periods_ns, [&](std::uint64_t period) { return static_cast<double>(period) > longest_ns; }));
  return timing;
}

void SequenceCount::add(std::uint32_t sequence) {
  numbered_ = numbered_ || sequence != 0;
  if (any_ && sequence > last_ + 1) {
    ++gaps_;
    missing_ += sequence - last_ - 1;
  }
  if (any_ && sequence <= last_) ++restarts_;
  last_ = sequence;
  any_ = true;
}

std::optional<std::uint64_t> missing_of_shared_counter(const std::vector<std::vector<std::uint32_t>>& of_channels) {
  if (of_channels.size() < 2) return std::nullopt;
  const auto missing_in = [](std::vector<std::uint32_t>& numbers) -> std::optional<std::uint64_t> {
    std::ranges::sort(numbers);
    if (std::ranges::adjacent_find(numbers) != numbers.end()) return std::nullopt;
    return std::uint64_t{numbers.back()} - numbers.front() + 1 - numbers.size();
  };
  std::vector<std::uint32_t> all;
  std::uint64_t missing_alone = 0;
  for (std::vector<std::uint32_t> numbers : of_channels) {
    all.insert(all.end(), numbers.begin(), numbers.end());
    missing_alone += missing_in(numbers).value_or(0);
  }
  const std::optional<std::uint64_t> missing = missing_in(all);
  return missing && *missing < missing_alone ? missing : std::nullopt;
}

std::map<std::string, std::string> RecordingReport::losses() const {
  constexpr char kLosses[] = "rtd:losses";
  const auto found = std::ranges::find(metadata, kLosses, &mcap::Metadata::name);
  return found == metadata.end() ? std::map<std::string, std::string>{} : found->metadata;
}

void RecordingReport::count_messages() {
  for (const ChannelReport& channel : channels) {
    const Timing& timing = channel.timing;
    if (timing.messages == 0) continue;
    start_ns = messages == 0 ? timing.first_ns : std::min(start_ns, timing.first_ns);
    end_ns = std::max(end_ns, timing.last_ns);
    messages += timing.messages;
  }
}

void RecordingReport::add_damage(const std::string& damage) {
  ++problem_count;
  data_lost = true;
  problems.push_back({mcap::ProblemKind::kDamagedRecord, 0, damage, "it is left out", true});
}

bool RecordingReport::damaged() const {
  return (data_lost && !being_written) ||
         std::ranges::any_of(problems, [this](const mcap::Problem& p) { return is_damage(p, being_written); });
}

RecordingReport report_on(const io::ByteSource& source, const ReportOptions& options) {
  RecordingReport report;
  report.file_bytes = source.size();
  if (!options.check && source.size() > options.small_file_bytes && report_from_summary(source, report)) return report;
  report = {};
  report.file_bytes = source.size();
  report_from_everything(source, options, report);
  return report;
}

}  // namespace rtd::recordings
