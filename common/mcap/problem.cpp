// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/problem.hpp"

#include <algorithm>

namespace rtd::mcap {

std::string name_of(ProblemKind kind) {
  switch (kind) {
    case ProblemKind::kNotMcap:
      return "not_mcap";
    case ProblemKind::kTruncated:
      return "truncated";
    case ProblemKind::kUnreadable:
      return "unreadable";
    case ProblemKind::kDamagedRecord:
      return "damaged_record";
    case ProblemKind::kCrcMismatch:
      return "crc_mismatch";
    case ProblemKind::kUnknownCompression:
      return "unknown_compression";
    case ProblemKind::kTooLarge:
      return "too_large";
    case ProblemKind::kMissingChannel:
      return "missing_channel";
    case ProblemKind::kMissingSchema:
      return "missing_schema";
    case ProblemKind::kConflictingDefinition:
      return "conflicting_definition";
    case ProblemKind::kMisplacedRecord:
      return "misplaced_record";
    case ProblemKind::kUnknownRecord:
      return "unknown_record";
    case ProblemKind::kIndexMismatch:
      return "index_mismatch";
    case ProblemKind::kNoSummary:
      return "no_summary";
  }
  return "unknown";
}

std::string to_string(const Problem& problem) {
  const std::string times = problem.count > 1 ? " (" + std::to_string(problem.count) + " times)" : "";
  return "offset " + std::to_string(problem.offset) + ": " + problem.what + times + "; " + problem.consequence;
}

void Problems::add(Problem problem) {
  ++total_;
  data_lost_ = data_lost_ || problem.data_lost;
  if (listed_.size() < max_listed_) listed_.push_back(std::move(problem));
}

void Problems::add_repeated(Problem problem) {
  const auto known = std::find_if(listed_.begin(), listed_.end(), [&](const Problem& listed) {
    return listed.kind == problem.kind && listed.what == problem.what;
  });
  if (known == listed_.end()) {
    add(std::move(problem));
  } else {
    ++known->count;
    ++total_;
  }
}

}  // namespace rtd::mcap
