// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/read_ahead.hpp"

#include <utility>

namespace rtd::camera {

ReadAhead::ReadAhead(FrameSource& source, std::size_t depth, std::uint64_t max_frames)
    : items_(depth, concurrency::Overflow::kBlock), max_frames_(max_frames) {
  thread_ = std::thread([this, &source] { read_all(source); });
}

void ReadAhead::read_all(FrameSource& source) {
  for (std::uint64_t frames_read = 0;;) {
    ReadItem item = read(source, frames_read);
    frames_read += item.passed_over + 1;
    const bool last = !item.frame;
    if (!items_.push(std::move(item)) || last) return;
  }
}

ReadAhead::~ReadAhead() {
  close();
  thread_.join();
}

ReadItem ReadAhead::read(FrameSource& source, std::uint64_t frames_read) const {
  ReadItem item;
  try {
    const std::int64_t oldest_wanted_ns = oldest_wanted_ns_;
    // A limited run counts what it reads: nothing is passed over there.
    if (max_frames_ == 0) item.passed_over = source.pass_over(oldest_wanted_ns);
    if (max_frames_ == 0 || frames_read < max_frames_) item.frame = source.next();
  } catch (const std::exception& error) {
    item.error = error.what();
  }
  item.skipped = source.take_skipped();
  item.counters = source.counters();
  return item;
}

}  // namespace rtd::camera
