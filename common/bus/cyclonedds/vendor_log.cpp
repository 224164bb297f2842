// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/vendor_log.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <mutex>

namespace rtd::bus::cyclonedds {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLinesAtOnce = 10;
constexpr std::chrono::seconds kPeriod{10};
constexpr std::size_t kLongestLine = 240;

std::string text_of(const dds_log_data_t& line) {
  std::string text(line.message, std::min<std::size_t>(line.size, kLongestLine));
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

/// Cyclone calls its sink from any thread, one call at a time or not.
struct Limit {
  std::mutex mutex;
  Clock::time_point begin;
  int lines = 0;
};

void print_some(void* self, const dds_log_data_t* line) {
  Limit& limit = *static_cast<Limit*>(self);
  const std::lock_guard lock(limit.mutex);
  const Clock::time_point now = Clock::now();
  if (now - limit.begin > kPeriod) {
    if (limit.lines > kLinesAtOnce) {
      std::fprintf(stderr, "Cyclone DDS: %d more lines like these\n", limit.lines - kLinesAtOnce);
    }
    limit.begin = now;
    limit.lines = 0;
  }
  if (++limit.lines <= kLinesAtOnce) std::fprintf(stderr, "Cyclone DDS: %s\n", text_of(*line).c_str());
}

}  // namespace

void limit_log() {
  static Limit limit;
  dds_set_log_sink(print_some, &limit);
}

std::string LogCapture::reason() const {
  const std::lock_guard lock(mutex_);
  return text_.empty() ? "" : ": " + text_;
}

void LogCapture::note(void* self, const dds_log_data_t* line) {
  LogCapture& capture = *static_cast<LogCapture*>(self);
  const std::lock_guard lock(capture.mutex_);
  std::string& text = capture.text_;
  if (text.size() < 2000) text += (text.empty() ? "" : "; ") + text_of(*line);
}

}  // namespace rtd::bus::cyclonedds
