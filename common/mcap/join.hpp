// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "common/io/byte_source.hpp"
#include "common/mcap/chunk_content.hpp"
#include "common/mcap/writer.hpp"

namespace rtd::mcap {

struct JoinOptions {
  WriterOptions writer;  ///< profile and library are those of the first part
  ReaderOptions reader;
  /// Called now and then with the bytes that were read of all parts; may be empty.
  std::function<void(std::uint64_t bytes)> progress;
};

struct JoinReport {
  Statistics joined;                ///< what the new file holds
  std::vector<Problem> problems;    ///< of the parts
  std::uint64_t problem_count = 0;  ///< with those that are not listed
  bool data_lost = false;
};

/// Copies the parts one behind the other into one well-formed file in the empty `sink`: messages byte by byte,
/// channels that are the same in several parts as one, attachments and metadata as they are (equal metadata once).
/// Throws io::IoError when the sink fails; nothing in the parts makes it throw.
JoinReport join(std::span<const io::ByteSource* const> parts, io::ByteSink& sink, const JoinOptions& options = {});

}  // namespace rtd::mcap
