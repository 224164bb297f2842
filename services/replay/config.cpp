// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/config.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rtd::replay {
namespace {

constexpr double kHighestRate = 1000, kLongestS = 1e9, kFastestClockHz = 10000;

void require(const char* name, double value, double max) {
  if (std::isfinite(value) && value >= 0 && value <= max) return;
  throw service::ConfigError(fmt::format("{} {}: give a number from 0 to {:g}", name, value, max));
}

}  // namespace

void ServiceConfig::bind(service::ConfigBinder& binder) {
  binder.field("file", file, "recording (MCAP) that is played");
  binder.field("rate", rate, {0, kHighestRate}, "speed, 1 = as recorded, 0 = as fast as possible");
  binder.field("loop", loop, "begin again at the end");
  binder.field("start_offset_s", start_offset_s, {0, kLongestS}, "where to begin, from the first message");
  binder.field("duration_s", duration_s, {0, kLongestS}, "how much to play, 0 = to the end");
  binder.field("topics", topics, "only these topics or patterns; empty = all but rtd/status");
  binder.field("exclude", exclude, "not these topics or patterns");
  binder.field("remap", remap, "old:=new");
  binder.field("clock_hz", clock_hz, {0, kFastestClockHz}, "rate of /clock, 0 = none");
  binder.field("pause", pause, "begin paused");
  binder.field("read_ahead_mb", read_ahead_mb, {1, 16384}, "read before it is due");
  binder.field("lockstep", lockstep, "topic whose messages let the next one of paced_topic go");
  binder.field("paced_topic", paced_topic, "topic that waits for answers; empty = rtd/frame, else rtd/features");
  binder.field("asap_window", asap_window, {1, 3}, "messages without an answer at a time, pace asap");
  binder.field("resend_after_ms", resend_after_ms, {10, 60000}, "silence after which messages are sent again");
  binder.field("result_timeout_s", result_timeout_s, {0.1, 3600}, "silence after which the replay has failed");
  binder.field("wait_for", wait_for, "services that must be ready before the first message");
  binder.field("start_timeout_s", start_timeout_s, {0, 3600}, "longest wait for them, and for who answers");
  binder.field("wait_readers_s", wait_readers_s, {0, 3600}, "longest wait for readers of reliable topics");
  binder.field("stand_in", stand_in, "services whose heartbeats are sent, e.g. detector: others count on its messages");
  binder.field("restamp", restamp, "published_ns of our frames and features becomes the time of the replay");
}

void validate(const ServiceConfig& config) {
  if (config.file.empty()) throw service::ConfigError("no recording is named: rtd replay FILE (replay.file)");
  require("--rate", config.rate, kHighestRate);
  require("--start-offset", config.start_offset_s, kLongestS);
  require("--duration", config.duration_s, kLongestS);
  require("--clock", config.clock_hz, kFastestClockHz);
  require("--wait-readers", config.wait_readers_s, 3600);
  require("--read-ahead", config.read_ahead_mb, 16384);
}

int window_of(const ServiceConfig& config, service::Pace pace) {
  if (pace == service::Pace::kAsap) return config.asap_window;
  return pace == service::Pace::kLockstep || !config.lockstep.empty() ? 1 : 0;
}

}  // namespace rtd::replay
