// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "services/recorder/inspect/recording_report.hpp"

namespace rtd::recording {

/// What `rtd info` prints.
std::string to_text(const RecordingReport& report, const std::string& name);
nlohmann::ordered_json to_json(const RecordingReport& report, const std::string& name);

nlohmann::ordered_json to_json(const mcap::Problem& problem);

/// The state of the checksums in a few words.
std::string checksum_text(const RecordingReport& report);

/// The problems, one per line, at most `most` of them.
std::string problems_text(const std::vector<mcap::Problem>& problems, std::uint64_t count, std::size_t most);

}  // namespace rtd::recording
