// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/worker_pool.hpp"

namespace rtd::detector {

WorkerPool::WorkerPool(int threads) {
  for (int i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  started_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void WorkerPool::for_each(std::size_t parts, const Work& work) {
  {
    const std::lock_guard lock(mutex_);
    work_ = &work;
    parts_ = parts;
    next_ = 0;
    helping_ = helpers_.size();
    ++job_;
  }
  started_.notify_all();
  run_parts();
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [this] { return helping_ == 0; });
}

void WorkerPool::help() {
  std::uint64_t done = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    started_.wait(lock, [&] { return closed_ || job_ != done; });
    if (closed_) return;
    done = job_;
    lock.unlock();
    run_parts();
    lock.lock();
    if (--helping_ == 0) ended_.notify_one();
  }
}

void WorkerPool::run_parts() {
  for (std::size_t part = next_++; part < parts_; part = next_++) (*work_)(part);
}

}  // namespace rtd::detector
