// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "common/io/byte_source.hpp"
#include "common/mcap/problem.hpp"
#include "common/mcap/records.hpp"

namespace rtd::recordings {

/// How regular the messages of a channel are, by log_time.
struct Timing {
  std::uint64_t messages = 0;
  mcap::Timestamp first_ns = 0, last_ns = 0;
  double rate_hz = 0;  ///< 0 for fewer than two messages or no time between them
  std::uint64_t median_period_ns = 0;
  std::uint64_t largest_gap_ns = 0;
  mcap::Timestamp largest_gap_at_ns = 0;  ///< where it starts
  std::uint64_t gaps = 0;                 ///< periods longer than kGapPeriods medians
};

inline constexpr double kGapPeriods = 2.5;

/// The times may be in any order.
Timing timing_of(std::vector<mcap::Timestamp> times_ns);

/// Counts missing sequence numbers of a channel. A number that is not larger than the one before comes from a restarted
/// writer or from another one.
class SequenceCount {
 public:
  void add(std::uint32_t sequence);
  /// Empty when the numbers start again: several writers and a restarted one look the same.
  std::optional<std::uint64_t> missing() const { return restarts_ > 0 ? std::nullopt : std::optional(missing_); }
  std::uint64_t gaps() const { return gaps_; }
  std::uint64_t restarts() const { return restarts_; }
  /// False when all numbers are 0: the recorder did not know them.
  bool numbered() const { return numbered_; }

 private:
  bool any_ = false, numbered_ = false;
  std::uint32_t last_ = 0;
  std::uint64_t missing_ = 0, gaps_ = 0, restarts_ = 0;
};

/// Missing numbers of one counter that all channels share, as eProsima's DDS Recorder has it. `of_channels`: the
/// numbers of each channel that has any. Empty when each channel counts for itself: then numbers occur in several
/// channels, or the channels together have no fewer gaps than each alone.
std::optional<std::uint64_t> missing_of_shared_counter(const std::vector<std::vector<std::uint32_t>>& of_channels);

/// One channel. Channels of one topic differ in their ids.
struct ChannelReport {
  mcap::Channel channel;
  std::string type, schema_encoding;  ///< empty: the channel has no schema
  bool schema_text = false;           ///< the full schema text is there
  Timing timing;
  std::optional<std::uint64_t> payload_bytes;  ///< only when everything was read
  std::optional<SequenceCount> sequences;      ///< only when everything was read
};

/// The chunks with one compression.
struct ChunkReport {
  std::uint64_t chunks = 0, bytes = 0, uncompressed_bytes = 0;
  std::uint64_t without_crc = 0;  ///< only when everything was read
};

struct RecordingReport {
  std::string format = "MCAP";  ///< or that of another program, whose files have neither summary nor checksums
  mcap::Header header;
  std::uint64_t file_bytes = 0;
  bool being_written = false;
  bool has_summary = false;
  bool read_all = false;  ///< every byte was read and every checksum compared, not only the summary
  std::uint64_t messages = 0;
  mcap::Timestamp start_ns = 0, end_ns = 0;  ///< log_time of the first and last message
  std::vector<ChannelReport> channels;       ///< by topic, then id
  /// Set when one sequence counter runs through all channels: its missing numbers. Gaps of one channel then say
  /// nothing.
  std::optional<std::uint64_t> missing_in_shared_counter;
  std::map<std::string, ChunkReport> chunks;  ///< by compression
  std::vector<mcap::AttachmentIndex> attachments;
  std::vector<mcap::Metadata> metadata;
  std::vector<mcap::Problem> problems;
  /// The losses that the recorder reports, by topic ("in_transit=3 in_queue=0") and "total". Empty: it reports none.
  std::map<std::string, std::string> losses() const;
  std::uint64_t problem_count = 0;  ///< including repeated and unlisted ones
  bool data_lost = false;           ///< something in the file, or missing from it, cannot be read

  /// Fills in what is known of all channels once they are there.
  void count_messages();
  /// A piece that could not be read, in the words of the reader.
  void add_damage(const std::string& damage);
  /// Something in the file was changed or is missing. A file that is still being written may end anywhere.
  bool damaged() const;
};

struct ReportOptions {
  bool check = false;                                    ///< read everything
  std::uint64_t small_file_bytes = 64 * 1024 * 1024;     ///< files up to this size are always read whole
  std::function<void(std::uint64_t bytes)> on_progress;  ///< bytes read so far; may be empty
};

/// Reads the summary and the message indexes, or the whole file if it is small, if these are missing or if asked to.
/// The content of the file never makes it throw.
RecordingReport report_on(const io::ByteSource& source, const ReportOptions& options = {});

/// What `rtd info` prints.
std::string to_text(const RecordingReport& report, const std::string& name);
nlohmann::ordered_json to_json(const RecordingReport& report, const std::string& name);

/// The state of the checksums in a few words.
std::string checksum_text(const RecordingReport& report);

/// The problems, one per line, at most `most` of them.
std::string problems_text(const std::vector<mcap::Problem>& problems, std::uint64_t count, std::size_t most);

}  // namespace rtd::recordings
