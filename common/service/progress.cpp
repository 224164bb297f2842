// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <utility>

namespace rtd::service {
namespace {

constexpr std::chrono::milliseconds kRewriteEvery{200}, kRepeatEvery{10000};
constexpr std::size_t kBarCells = 20;

}  // namespace

std::string progress_line(const std::string& work, std::uint64_t done, std::uint64_t total, double elapsed_s) {
  const double part = total == 0 ? 1 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const auto cells = static_cast<std::size_t>(part * kBarCells);
  const std::string left = part > 0 ? fmt::format(", {:.0f} s left", elapsed_s * (1 - part) / part) : "";
  return fmt::format("{} [{}{}] {:3.0f} %{}", work, std::string(cells, '#'), std::string(kBarCells - cells, '.'),
                     100 * part, left);
}

Progress::Progress(std::ostream& err, std::string work, std::uint64_t total)
    : err_(err),
      work_(std::move(work)),
      total_(total),
      interactive_(&err == &std::cerr && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (interactive_ && shown_) err_ << "\r\033[K" << std::flush;
}

void Progress::reach(std::uint64_t done) {
  done_ = done;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + (interactive_ ? kRewriteEvery : kRepeatEvery);
  const std::string line = progress_line(work_, done_, total_, std::chrono::duration<double>(now - started_).count());
  err_ << (interactive_ ? "\r\033[K" + line : line + '\n') << std::flush;
  shown_ = true;
}

}  // namespace rtd::service
