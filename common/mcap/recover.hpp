// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "common/io/byte_source.hpp"
#include "common/mcap/chunk_content.hpp"
#include "common/mcap/writer.hpp"

namespace rtd::mcap {

struct RecoverOptions {
  WriterOptions writer;  ///< profile and library are those of the source
  ReaderOptions reader;
  /// Called now and then with the bytes that were read of the source; may be empty.
  std::function<void(std::uint64_t bytes)> progress;
};

struct RecoverReport {
  Statistics recovered;                 ///< what the new file holds
  std::optional<Statistics> announced;  ///< the source's own statistics, where they can still be read
  std::vector<Problem> problems;        ///< of the source
  std::uint64_t problem_count = 0;      ///< with those that are not listed
  bool data_lost = false;

  /// Messages that the source announces and that are not in the new file; empty when it announces none.
  std::optional<std::uint64_t> messages_lost() const;
};

/// Copies everything of `source` that is whole, in file order, byte by byte, into a well-formed file with summary in
/// the empty `sink`. Throws io::IoError when the sink fails; nothing in the source makes it throw.
RecoverReport recover(const io::ByteSource& source, io::ByteSink& sink, const RecoverOptions& options = {});

}  // namespace rtd::mcap
