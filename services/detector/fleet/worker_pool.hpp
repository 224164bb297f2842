// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace rtd::detector {

/// Threads that share the parts of a job. cv::parallel_for_() has one number of threads for the whole process, which
/// belongs to the network.
class WorkerPool {
 public:
  using Work = std::function<void(std::size_t part)>;

  /// `threads` at least 1; the thread that calls for_each() is one of them.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Runs work(0) to work(parts - 1), each once, and returns when all have ended. `work` must not throw. To be called
  /// by one thread at a time.
  void for_each(std::size_t parts, const Work& work);

 private:
  void help();
  void run_parts();

  std::mutex mutex_;
  std::condition_variable started_, ended_;
  const Work* work_ = nullptr;
  std::size_t parts_ = 0;
  std::atomic<std::size_t> next_{0};
  std::uint64_t job_ = 0;
  std::size_t helping_ = 0;  ///< threads that have not finished this job
  bool closed_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace rtd::detector
