// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/read_ahead.hpp"

#include <algorithm>
#include <utility>

namespace rtd::camera {

ReadAhead::ReadAhead(FrameSource& source, std::size_t depth, std::uint64_t max_frames,
                     std::function<std::int64_t()> now_ns)
    : source_(source),
      items_(depth, concurrency::Overflow::kBlock),
      max_frames_(max_frames),
      now_ns_(std::move(now_ns)) {
  thread_ = std::thread([this] { read_all(); });
}

void ReadAhead::read_all() {
  for (std::uint64_t frames_read = 0;;) {
    ReadItem item = read(frames_read);
    frames_read += item.passed_over + 1;
    const bool last = !item.frame;
    if (!items_.push(std::move(item)) || last) return;
  }
}

ReadAhead::~ReadAhead() {
  close();
  thread_.join();
}

ReadItem ReadAhead::read(std::uint64_t frames_read) const {
  ReadItem item;
  item.begin_ns = now_ns_();
  try {
    const std::uint64_t left = max_frames_ == 0 ? std::numeric_limits<std::uint64_t>::max() : max_frames_ - frames_read;
    item.passed_over = std::min(source_.pass_over(oldest_wanted_ns_), left);
    if (item.passed_over < left) item.frame = source_.next();
    if (item.frame && !item.frame->T_world_camera)
      item.frame->T_world_camera = source_.true_pose(item.frame->image.stamp_ns);
  } catch (const std::exception& error) {
    item.error = error.what();
  }
  item.skipped = source_.take_skipped();
  item.counters = source_.counters();
  item.end_ns = now_ns_();
  return item;
}

}  // namespace rtd::camera
