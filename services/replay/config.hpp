// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/pacer.hpp"

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
  std::string lockstep;  ///< with --pace lockstep or asap an empty topic becomes rtd/tracking
  std::string paced_topic;
  int asap_window = 3;
  int resend_after_ms = 2000;
  double result_timeout_s = 30;
  std::vector<std::string> wait_for;
  double start_timeout_s = 30;
  double wait_readers_s = 1;
  std::vector<std::string> stand_in;
  bool restamp = false;
  bool json = false;

  static constexpr double kHighestRate = 1000, kLongestS = 1e9, kFastestClockHz = 10000;
  static constexpr int kMostReadAheadMb = 16384;

  void bind(auto& binder) {
    binder.field("file", file, "recording (MCAP) to play");
    binder.field("rate", rate, {0, kHighestRate}, "speed, 1 = as recorded, 0 = as fast as possible");
    binder.field("loop", loop, "start again at the end");
    binder.field("start_offset_s", start_offset_s, {0, kLongestS}, "where to start, from the first message");
    binder.field("duration_s", duration_s, {0, kLongestS}, "how much to play, 0 = to the end");
    binder.field("topics", topics, "play only these topics or patterns; empty = all but rtd/status");
    binder.field("exclude", exclude, "leave these topics or patterns out");
    binder.field("remap", remap, "rename topics: old:=new");
    binder.field("clock_hz", clock_hz, {0, kFastestClockHz}, "rate of /clock, 0 = none");
    binder.field("pause", pause, "start paused");
    binder.field("read_ahead_mb", read_ahead_mb, {1, kMostReadAheadMb}, "how much is read before it is due");
    binder.field("lockstep", lockstep, "topic whose messages let the next message of paced_topic go");
    binder.field("paced_topic", paced_topic, "topic that waits for answers; empty = rtd/frame, else rtd/features");
    binder.field("asap_window", asap_window, {1, 3}, "messages without an answer at a time, pace asap");
    binder.field("resend_after_ms", resend_after_ms, {10, 60000}, "silence after which messages are sent again");
    binder.field("result_timeout_s", result_timeout_s, {0.1, 3600}, "silence after which the replay has failed");
    binder.field("wait_for", wait_for, "services that must be ready before the first message");
    binder.field("start_timeout_s", start_timeout_s, {0, 3600}, "longest wait for these services and for the answers");
    binder.field("wait_readers_s", wait_readers_s, {0, 3600}, "longest wait for readers of reliable topics");
    binder.field("stand_in", stand_in, "services to send heartbeats for, e.g. detector: others rely on its messages");
    binder.field("restamp", restamp, "set published_ns of our frames and features to the time of the replay");
  }
};

/// Throws ConfigError naming the option, the value and what is allowed.
void validate(const ServiceConfig& config);

/// How many paced messages may be without an answer; 0: messages go by time.
int window_of(const ServiceConfig& config, service::Pace pace);

}  // namespace rtd::replay
