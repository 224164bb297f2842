// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "common/mcap/byte_source.hpp"
#include "common/mcap/problem.hpp"
#include "services/recorder/inspect/timing.hpp"

namespace rtd::recording {

/// What is known of one channel. Channels of one topic are told apart by their ids.
struct ChannelReport {
  mcap::Channel channel;
  std::string type, schema_encoding;  ///< empty: the channel has no schema
  bool schema_text = false;           ///< the schema is there in full
  Timing timing;
  std::optional<std::uint64_t> payload_bytes;  ///< only when everything was read
  std::optional<SequenceCount> sequences;      ///< only when everything was read
};

/// The chunks that go by one compression.
struct ChunkReport {
  std::uint64_t chunks = 0, bytes = 0, uncompressed_bytes = 0;
  std::uint64_t without_crc = 0;  ///< only when everything was read
};

struct RecordingReport {
  mcap::Header header;
  std::uint64_t file_bytes = 0;
  bool being_written = false;
  bool has_summary = false;
  bool read_all = false;  ///< every byte was read and every checksum compared; else only the summary
  std::uint64_t messages = 0;
  mcap::Timestamp start_ns = 0, end_ns = 0;   ///< log_time of the first and last message
  std::vector<ChannelReport> channels;        ///< by topic, then id
  std::map<std::string, ChunkReport> chunks;  ///< by compression
  std::vector<mcap::AttachmentIndex> attachments;
  std::vector<mcap::Metadata> metadata;
  std::vector<mcap::Problem> problems;
  /// What the recorder itself says: messages that it knows to be lost, by topic ("in_transit=3 in_queue=0") and
  /// "total". Empty: it does not say.
  std::map<std::string, std::string> losses() const;
  std::uint64_t problem_count = 0;  ///< those that repeat and those that are not listed counted too
  bool data_lost = false;           ///< something that the file held or should hold cannot be read

  /// Something in the file is not as it was written or not there. A file that is being written may end anywhere.
  bool damaged() const;
};

struct ReportOptions {
  bool check = false;                                    ///< read everything
  std::uint64_t small_file_bytes = 64 * 1024 * 1024;     ///< up to this everything is read anyway
  std::function<void(std::uint64_t bytes)> on_progress;  ///< bytes read so far; may be empty
};

/// Reads the summary and the message indexes or, where it is asked for, the file is small or these are not there, the
/// whole file. Never throws for what is in the file.
RecordingReport report_on(const mcap::ByteSource& source, const ReportOptions& options = {});

}  // namespace rtd::recording
