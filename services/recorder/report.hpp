// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/recorder/core/recording.hpp"

namespace rtd::recorder {

/// The result of a recording.
struct RecordingReport {
  std::vector<std::string> names;  ///< of the files, in the folder
  std::string folder;
  std::vector<FileSummary> files;
  std::vector<RecordedTopic> topics;
  std::uint64_t acknowledged_bytes = 0;
  double duration_s = 0;
  std::string failure;  ///< why it ended early; empty: it was stopped
  bool partial() const;
};

std::string report_json(const RecordingReport& report);

/// The losses, as metadata of the file.
mcap::Metadata loss_metadata(const std::vector<RecordedTopic>& topics);

/// The progress of a recording, for one line on a terminal.
struct ProgressFacts {
  double elapsed_s = 0, bytes_per_s = 0;
  TopicCounts totals;
  std::uint64_t file_bytes = 0, free_bytes = 0;
};
std::string progress_text(const ProgressFacts& facts);

}  // namespace rtd::recorder
