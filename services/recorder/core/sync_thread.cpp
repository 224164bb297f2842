// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/sync_thread.hpp"

#include <utility>

namespace rtd::recorder {

SyncThread::SyncThread(std::chrono::milliseconds pause) : pause_(pause), thread_([this] { loop(); }) {}

void SyncThread::put(std::shared_ptr<io::ByteSink> sink, Acknowledged written) {
  {
    const std::lock_guard lock(mutex_);
    // Of one sink only the newest mark counts.
    if (!marks_.empty() && marks_.back().sink == sink) marks_.pop_back();
    marks_.push_back({std::move(sink), std::move(written)});
  }
  changed_.notify_one();
}

Acknowledged SyncThread::acknowledged() const {
  const std::lock_guard lock(mutex_);
  return acknowledged_;
}

std::string SyncThread::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void SyncThread::finish() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void SyncThread::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ended_ || !marks_.empty(); });
    if (marks_.empty()) return;
    const std::deque<Mark> marks = std::exchange(marks_, {});
    lock.unlock();
    sync(marks);
    lock.lock();
    changed_.wait_for(lock, pause_, [this] { return ended_; });
  }
}

/// In order: a mark counts when all before it are durable too.
void SyncThread::sync(const std::deque<Mark>& marks) {
  for (const Mark& mark : marks) {
    std::string failure;
    try {
      mark.sink->sync();
    } catch (const io::IoError& error) {
      failure = error.what();
    }
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = failure;
    if (failure_.empty()) acknowledged_ = mark.written;
  }
}

}  // namespace rtd::recorder
