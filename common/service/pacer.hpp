// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
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

/// When frames are sent.
struct PacerConfig {
  /// Frames that may be without a result at a time (1: lockstep, 3: asap). 0: by their stamps (realtime).
  int window = 0;
  bool at_once = false;                             ///< realtime: a running camera, whose frames are never early
  std::int64_t late_after_ns = 33'333'333;          ///< realtime: a frame later than this is skipped for a newer one
  std::int64_t max_gap_ns = 1'000'000'000;          ///< realtime: longest pause between two stamps that is played
  std::int64_t max_lateness_ns = 500'000'000;       ///< realtime: beyond this the timeline is shifted, not skipped
  std::int64_t resend_after_ns = 2'000'000'000;     ///< window: silence after which the frames in flight are sent again
  std::int64_t result_timeout_ns = 30'000'000'000;  ///< window: silence after which the run has failed
};

enum class PaceAction {
  kSend,      ///< send the next frame now
  kWait,      ///< nothing to do for wait_ns, or until a result arrives
  kSkipLate,  ///< realtime: leave the next frame out, it is late
  kResend,    ///< window: send the frames in flight again, oldest first
  kGiveUp,    ///< window: no result within the timeout
};

struct PaceDecision {
  PaceAction action = PaceAction::kSend;
  std::int64_t wait_ns = 0;
  std::int64_t late_ns = 0;     ///< realtime: how far the frame is behind its time, when more than late_after_ns
  std::int64_t cut_gap_ns = 0;  ///< realtime: how much of the pause before this frame is left out
  std::int64_t shifted_ns = 0;  ///< realtime: how much the timeline was shifted because the source is too slow
};

/// Decides when the next frame goes out. It has no thread and no clock: the caller asks, and reports what was sent and
/// answered. A result for frame n answers all frames up to n.
class Pacer {
 public:
  Pacer(const PacerConfig& config, std::function<std::int64_t()> now_ns);

  /// What to do about the frame with this stamp, the next one of the source, while `newer_waiting` frames are ready
  /// behind it. A late frame is only skipped for a newer one: a source that is too slow still gives what it can.
  PaceDecision next(std::int64_t stamp_ns, std::size_t newer_waiting = 1);
  /// After the last frame: kWait while results are missing, kResend, kGiveUp; kSend when every frame is answered.
  PaceDecision drain();

  void sent(std::uint64_t seq);  ///< the next frame went out
  void resent();                 ///< the frames in flight went out again
  void answered(std::uint64_t seq);

  const std::deque<std::uint64_t>& in_flight() const { return in_flight_; }
  std::uint64_t late() const { return late_; }
  std::uint64_t resends() const { return resends_; }

 private:
  PaceDecision by_stamp(std::int64_t stamp_ns, std::size_t newer_waiting);
  PaceDecision by_window(std::size_t room);
  void advance_timeline(std::int64_t stamp_ns, PaceDecision& decision);
  void exclude_standstill(std::int64_t now_ns);

  PacerConfig config_;
  std::function<std::int64_t()> now_ns_;
  std::deque<std::uint64_t> in_flight_;
  std::int64_t last_sent_ns_ = 0;                  ///< window: send or resend
  std::int64_t last_progress_ns_ = 0;              ///< window: first frame of a burst or result
  std::optional<std::int64_t> asked_ns_;           ///< window: when the caller asked last
  std::optional<std::int64_t> stamp_ns_, due_ns_;  ///< realtime: frame on the timeline and when it is due
  std::uint64_t late_ = 0, resends_ = 0;
};

}  // namespace rtd::service
