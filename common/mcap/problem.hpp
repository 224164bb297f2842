// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rtd::mcap {

enum class ProblemKind {
  kNotMcap,                ///< no MCAP magic at the start or the end
  kTruncated,              ///< the file ends inside a record or without its footer
  kUnreadable,             ///< the disk gave fewer bytes than the file has
  kDamagedRecord,          ///< lengths or fields that cannot be
  kCrcMismatch,            ///< content and its CRC differ
  kUnknownCompression,     ///< a chunk names a compression that is not "", lz4 or zstd
  kTooLarge,               ///< a record or chunk above ReaderOptions::max_record_bytes, or above what it can become
  kMissingChannel,         ///< messages without a Channel record before them
  kMissingSchema,          ///< a channel that names a schema without a Schema record before it
  kConflictingDefinition,  ///< one id, two meanings
  kMisplacedRecord,        ///< a record where the format does not allow it
  kUnknownRecord,          ///< a record type of a later version or of another program
  kIndexMismatch,          ///< an index or statistic that is not what the file holds
  kNoSummary,              ///< no usable summary: the file had to be read from the start
};

/// The name of the kind for logs and JSON, e.g. "crc_mismatch".
std::string name_of(ProblemKind kind);

/// One thing that is wrong with a file, for a person to read.
struct Problem {
  ProblemKind kind{};
  std::uint64_t offset = 0;  ///< byte in the file where it begins
  std::string what;          ///< e.g. "Chunk: the CRC of its content is 0x1234, it says 0x5678"
  std::string consequence;   ///< e.g. "its messages are left out"
  bool data_lost = false;    ///< something that the file held or should hold is not delivered
  std::uint64_t count = 1;   ///< how often, for problems that repeat
};

/// False for what a whole file may have or lack: records of a later version, a summary.
bool is_damage(const Problem& problem);

/// "offset 123: what; consequence"
std::string to_string(const Problem& problem);

/// The problems of one file, bounded in number: those beyond `max_listed` are only counted.
class Problems {
 public:
  explicit Problems(std::size_t max_listed) : max_listed_(max_listed) {}

  void add(Problem problem);
  /// Counts one more of the problem of this kind with this text, or adds it.
  void add_repeated(Problem problem);

  const std::vector<Problem>& listed() const { return listed_; }
  std::uint64_t total() const { return total_; }
  bool data_lost() const { return data_lost_; }

 private:
  std::size_t max_listed_;
  std::vector<Problem> listed_;
  std::map<std::pair<ProblemKind, std::string>, std::size_t> place_of_;  ///< in listed_
  std::uint64_t total_ = 0;
  bool data_lost_ = false;
};

}  // namespace rtd::mcap
