// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::service {

/// How frames are paced through the system (docs/architecture.md, "Pacing").
enum class Pace {
  kRealtime,  ///< recorded stamps; late frames are dropped and counted; no service waits for the detector
  kAsap,      ///< as fast as the slowest stage, a bounded window of frames in flight, nothing dropped
  kLockstep,  ///< the next frame after the pose of this one, mapping synchronous: same input, same bits
};

/// "realtime", "asap" or "lockstep"; throws ConfigError with the three names otherwise.
Pace parse_pace(const std::string& text);
const char* to_string(Pace pace);

}  // namespace rtd::service
