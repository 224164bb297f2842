// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "common/mcap/chunk_content.hpp"
#include "common/mcap/writer.hpp"

/// Well-formed files from damaged, unfinished or split ones. Both functions write into the empty `sink` and throw
/// io::IoError when it fails; nothing in what they read makes them throw.
namespace rtd::mcap {

struct CopyOptions {
  WriterOptions writer;  ///< profile and library are those of the (first) source
  ReaderOptions reader;
  /// Called now and then with the bytes that were read of all sources; may be empty.
  std::function<void(std::uint64_t bytes)> progress;
};
using RecoverOptions = CopyOptions;
using JoinOptions = CopyOptions;

/// What was wrong with the sources.
struct CopyReport {
  std::vector<Problem> problems;
  std::uint64_t problem_count = 0;  ///< with those that are not listed
  bool data_lost = false;
};

struct RecoverReport : CopyReport {
  Statistics recovered;                 ///< what the new file holds
  std::optional<Statistics> announced;  ///< the source's own statistics, where they can still be read
  /// Messages that the source announces and that are not in the new file; empty when it announces none.
  std::optional<std::uint64_t> messages_lost() const;
};

struct JoinReport : CopyReport {
  Statistics joined;  ///< what the new file holds
};

/// Copies everything of `source` that is whole, in file order, byte by byte, into a file with summary. Of an
/// uncompressed chunk that the end of the file cuts, the whole messages; no checksum covers these.
RecoverReport recover(const io::ByteSource& source, io::ByteSink& sink, const RecoverOptions& options = {});

/// Copies the parts one behind the other: messages byte by byte, channels that are the same in several parts as one,
/// attachments and metadata as they are (equal metadata once).
JoinReport join(std::span<const io::ByteSource* const> parts, io::ByteSink& sink, const JoinOptions& options = {});

}  // namespace rtd::mcap
