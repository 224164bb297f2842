// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

namespace rtd::detector {

/// How one robot was served in the last seconds.
struct AnswerSummary {
  double rate_hz = 0;
  double latency_p50_ms = 0, latency_p99_ms = 0;  ///< from the arrival of the image to its published detections
  double batch_mean = 0;                          ///< images computed together with those of this robot
};

/// Keeps the answers of the last kWindowNs. Times are given. Not thread-safe.
class AnswerStats {
 public:
  static constexpr std::int64_t kWindowNs = 5'000'000'000;

  void add(std::int64_t arrived_ns, std::int64_t answered_ns, std::size_t batch);
  /// Of the window that ends now; zeros without answers.
  AnswerSummary summary(std::int64_t now_ns);

 private:
  struct Answer {
    std::int64_t answered_ns = 0, latency_ns = 0;
    std::size_t batch = 0;
  };
  static constexpr std::size_t kMaxAnswers = 2000;

  std::int64_t first_ns_ = 0;  ///< of all answers; 0: none yet
  std::deque<Answer> answers_;
};

}  // namespace rtd::detector
