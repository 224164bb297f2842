// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/launcher/run/run_options.hpp"

namespace rtd::launcher {

/// What of a recording stands in for services of a run: rtd-replay plays it in place of the camera.
struct ReplaySetup {
  std::string file;                 ///< empty: nothing is replayed
  bool detections = false;          ///< the recorded boxes; no detector runs
  bool features = false;            ///< the recorded features; neither detector nor filter runs
  std::uint64_t frames = 0;         ///< that the run is made of
  std::vector<std::string> topics;  ///< that are played: what is needed, then what others like to see

  explicit operator bool() const { return !file.empty(); }
  /// For rtd-replay.
  std::vector<std::string> arguments(const std::vector<std::string>& wait_for) const;
};

/// From --replay-topics. Throws service::ConfigError: not an MCAP source, a recording without the topic (with those
/// that it has), options that need a camera.
ReplaySetup choose_replay(const RunOptions& options, const std::string& source);

}  // namespace rtd::launcher
