// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/status_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace rtd::replay {
namespace {

constexpr std::int64_t kRewriteEveryNs = 100'000'000;
constexpr std::size_t kCells = 20;

}  // namespace

std::string status_text(const PlayState& state, std::int64_t start_ns, std::int64_t end_ns) {
  const double done_s = static_cast<double>(state.recorded_ns - start_ns) * 1e-9;
  const double whole_s = static_cast<double>(end_ns - start_ns) * 1e-9;
  const double part = whole_s > 0 ? std::clamp(done_s / whole_s, 0.0, 1.0) : 1;
  const auto cells = static_cast<std::size_t>(part * kCells);
  return fmt::format("{:.1f} of {:.1f} s [{}{}] {}, {} messages{}", done_s, whole_s, std::string(cells, '#'),
                     std::string(kCells - cells, '.'),
                     state.rate > 0 ? fmt::format("{:.2f}x", state.rate) : "as fast as possible", state.sent,
                     state.paused ? ", paused" : "");
}

StatusLine::StatusLine(std::int64_t start_ns, std::int64_t end_ns)
    : start_ns_(start_ns), end_ns_(end_ns), interactive_(isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() {
  if (interactive_) std::cerr << "\r\033[K" << std::flush;
}

void StatusLine::show(const PlayState& state, std::int64_t now_ns) {
  if (!interactive_ || (now_ns < next_ns_ && state.paused == paused_)) return;
  next_ns_ = now_ns + kRewriteEveryNs;
  paused_ = state.paused;
  std::cerr << "\r\033[K" << status_text(state, start_ns_, end_ns_) << std::flush;
}

}  // namespace rtd::replay
