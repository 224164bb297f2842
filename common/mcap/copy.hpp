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

/// What the new file holds, and what was wrong with the sources.
struct CopyReport {
  Statistics copied;
  std::optional<std::uint64_t> announced;  ///< messages by a source's own statistics, where they can still be read
  std::vector<Problem> problems;
  std::uint64_t problem_count = 0;  ///< with those that are not listed
  bool data_lost = false;
  /// Messages that the sources announce and that are not in the new file; empty when they announce none.
  std::optional<std::uint64_t> messages_lost() const;
};

/// Copies the parts one behind the other: messages byte by byte, channels and schemas that are the same in several
/// parts as one, attachments and metadata as they are (equal metadata once).
CopyReport join(std::span<const io::ByteSource* const> parts, io::ByteSink& sink, const CopyOptions& options = {});

/// The same for everything of a source that is whole, in file order. Of an uncompressed chunk that the end of the file
/// cuts, the whole messages; no checksum covers these.
CopyReport recover(const io::ByteSource& source, io::ByteSink& sink, CopyOptions options = {});

}  // namespace rtd::mcap
