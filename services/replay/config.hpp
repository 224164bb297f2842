// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/pace.hpp"
#include "services/replay/core/player.hpp"

namespace rtd::replay {

/// Section `replay` of the configuration.
struct ServiceConfig {
  std::string file;
  double rate = 1;
  bool loop = false;
  double start_offset_s = 0, duration_s = 0;
  std::vector<std::string> topics, exclude;
  std::vector<std::string> remap;
  double clock_hz = 0;
  bool pause = false;
  int read_ahead_mb = 64;
  std::string lockstep;
  std::string paced_topic;
  int asap_window = 3;
  int resend_after_ms = 2000;
  double result_timeout_s = 30;
  std::vector<std::string> wait_for;
  double start_timeout_s = 30;
  double wait_readers_s = 1;
  bool restamp = false;
  std::vector<std::string> stand_in;
  bool json = false;

  static constexpr double kHighestRate = 1000, kLongest_s = 1e9, kFastestClock_hz = 10000;

  void bind(auto& binder) {
    binder.field("file", file, "recording (MCAP) that is played");
    binder.field("rate", rate, {0, kHighestRate}, "speed, 1 = as recorded, 0 = as fast as possible");
    binder.field("loop", loop, "begin again at the end");
    binder.field("start_offset_s", start_offset_s, {0, kLongest_s}, "where to begin, from the first message");
    binder.field("duration_s", duration_s, {0, kLongest_s}, "how much to play, 0 = to the end");
    binder.field("topics", topics, "only these topics or patterns; empty = all but rtd/status");
    binder.field("exclude", exclude, "not these topics or patterns");
    binder.field("remap", remap, "new names of topics, old:=new");
    binder.field("clock_hz", clock_hz, {0, kFastestClock_hz}, "rate of /clock, 0 = none");
    binder.field("pause", pause, "begin paused");
    binder.field("read_ahead_mb", read_ahead_mb, {1, 16384}, "data read before it is due");
    binder.field("lockstep", lockstep,
                 "topic whose messages release the next one of paced_topic; empty: none, with pace asap and lockstep "
                 "rtd/tracking");
    binder.field("paced_topic", paced_topic, "topic that waits for answers; empty = rtd/frame, else rtd/features");
    binder.field("asap_window", asap_window, {1, 3}, "messages without an answer at a time, pace asap");
    binder.field("resend_after_ms", resend_after_ms, {10, 60000}, "silence after which messages are sent again");
    binder.field("result_timeout_s", result_timeout_s, {0.1, 3600}, "silence after which the replay has failed");
    binder.field("wait_for", wait_for, "services that must be ready before the first message");
    binder.field("start_timeout_s", start_timeout_s, {0, 3600},
                 "longest wait for these services, and for the one that answers");
    binder.field("wait_readers_s", wait_readers_s, {0, 3600}, "longest wait for readers of reliable topics");
    binder.field("stand_in", stand_in,
                 "services whose heartbeats are sent, e.g. detector: others then rely on its messages");
    binder.field("restamp", restamp, "published_ns of our frames and features becomes the time of the replay");
  }
};

/// Throws ConfigError naming the option, the value and what is allowed.
void validate(const ServiceConfig& config);

/// How many paced messages may be without an answer; 0: by time.
int window_of(const ServiceConfig& config, service::Pace pace);

}  // namespace rtd::replay
