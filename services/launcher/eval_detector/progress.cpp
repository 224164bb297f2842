// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/eval_detector/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <ostream>
#include <utility>

namespace rtd::launcher {
namespace {

constexpr std::chrono::milliseconds kRewriteEvery{200}, kRepeatEvery{10000};

}  // namespace

Progress::Progress(std::ostream& err, std::string work, std::size_t total)
    : err_(err),
      work_(std::move(work)),
      total_(total),
      interactive_(&err == &std::cerr && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (interactive_ && shown_) err_ << "\r\033[K" << std::flush;
}

void Progress::advance() {
  ++done_;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + (interactive_ ? kRewriteEvery : kRepeatEvery);
  const double elapsed_s = std::chrono::duration<double>(now - started_).count();
  const double left_s = elapsed_s * static_cast<double>(total_ - done_) / static_cast<double>(done_);
  const std::string line = fmt::format("{} {}/{}, {:.0f} s left", work_, done_, total_, left_s);
  err_ << (interactive_ ? "\r\033[K" + line : line + '\n') << std::flush;
  shown_ = true;
}

}  // namespace rtd::launcher
