// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// Counts what a source leaves out and keeps the lines for the log until they are taken.
class SkipLog {
 public:
  void add(SkippedInput input);
  SourceCounters& counters() { return counters_; }
  const SourceCounters& counters() const { return counters_; }
  std::vector<SkippedInput> take() { return std::exchange(skipped_, {}); }
  /// ": 2 x size_mismatch, first: ..."; empty when nothing was left out.
  std::string summary() const;

 private:
  SourceCounters counters_;
  std::vector<SkippedInput> skipped_;
};

}  // namespace rtd::camera
