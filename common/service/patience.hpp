// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "common/service/pacer.hpp"

namespace rtd::service {

/// How long a run waits for one of its services, in the order in which the limits apply: a worker that is stuck is
/// found, its process killed and started again, before those who wait for its answers go on without them or give up.
struct Patience {
  int stuck_ms;   ///< a worker without progress says that it is stuck
  int silent_ms;  ///< a process without a sign of life is killed and restarted by the launcher
  int answer_ms;  ///< for what a living service says about one frame; in realtime none is waited for
  int result_ms;  ///< without any result, after which the run has failed; in realtime none is waited for
};

/// In real time a camera does not wait. Where every frame is played one may take its time, closing loops and all, also
/// on a busy host.
constexpr Patience patience_of(Pace pace) {
  return pace == Pace::kRealtime ? Patience{1'500, 3'000, 0, 0} : Patience{30'000, 10'000, 60'000, 90'000};
}

/// How often a service without a frame looks at its state: until its first one, others wait for it to be ready.
constexpr std::chrono::milliseconds state_period(bool begun) {
  return std::chrono::milliseconds(begun ? 50 : 5);
}

/// Of the paces that play every frame.
inline constexpr Patience kEveryFramePatience = patience_of(Pace::kLockstep);
static_assert(kEveryFramePatience.stuck_ms + kEveryFramePatience.silent_ms < kEveryFramePatience.answer_ms);
static_assert(kEveryFramePatience.answer_ms < kEveryFramePatience.result_ms);

}  // namespace rtd::service
