// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::msg {

/// How fast a replay may play: 1 = as recorded.
inline constexpr double kLowestReplayRate = 0.01, kHighestReplayRate = 1000;

}  // namespace rtd::msg
