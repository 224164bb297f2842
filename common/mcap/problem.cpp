// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/problem.hpp"

#include <iterator>

namespace rtd::mcap {

std::string name_of(ProblemKind kind) {
  constexpr const char* kNames[] = {"not_mcap",         "truncated",
                                    "unreadable",       "damaged_record",
                                    "crc_mismatch",     "unknown_compression",
                                    "too_large",        "missing_channel",
                                    "missing_schema",   "conflicting_definition",
                                    "misplaced_record", "unknown_record",
                                    "index_mismatch",   "no_summary"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(ProblemKind::kNoSummary) + 1);
  return kNames[static_cast<std::size_t>(kind)];
}

bool is_damage(const Problem& problem) {
  const bool legal = problem.kind == ProblemKind::kUnknownRecord || problem.kind == ProblemKind::kNoSummary;
  return !legal || problem.data_lost;
}

std::string to_string(const Problem& problem) {
  const std::string times = problem.count > 1 ? " (" + std::to_string(problem.count) + " times)" : "";
  return "offset " + std::to_string(problem.offset) + ": " + problem.what + times + "; " + problem.consequence;
}

void Problems::add(Problem problem) {
  ++total_;
  data_lost_ = data_lost_ || problem.data_lost;
  if (listed_.size() >= max_listed_) return;
  place_of_.try_emplace({problem.kind, problem.what}, listed_.size());
  listed_.push_back(std::move(problem));
}

void Problems::add_repeated(Problem problem) {
  const auto known = place_of_.find({problem.kind, problem.what});
  if (known == place_of_.end()) {
    add(std::move(problem));
  } else {
    ++listed_[known->second].count;
    ++total_;
  }
}

}  // namespace rtd::mcap
