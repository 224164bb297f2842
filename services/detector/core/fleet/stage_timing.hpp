// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace rtd::detector {

/// When the next batch is to be taken and decoded while the network computes the one before: as late as it can be, so
/// that its images are the newest, and early enough that the network does not wait. Times are given. Not thread-safe.
class StageTiming {
 public:
  void decoded(std::int64_t duration_ns) { decode_ns_ = smooth(decode_ns_, duration_ns); }
  void inferred(std::size_t images, std::int64_t duration_ns) {
    infer_image_ns_ =
        smooth(infer_image_ns_, duration_ns / static_cast<std::int64_t>(std::max<std::size_t>(images, 1)));
  }
  /// How long after the network has begun with so many images the next ones are to be taken.
  std::chrono::nanoseconds delay(std::size_t images) const {
    const std::int64_t infer_ns = static_cast<std::int64_t>(images) * infer_image_ns_;
    return std::chrono::nanoseconds(std::max<std::int64_t>(0, infer_ns - decode_ns_));
  }

 private:
  /// A mean that forgets: a quarter is the newest.
  static std::int64_t smooth(std::int64_t mean_ns, std::int64_t value_ns) {
    return mean_ns == 0 ? value_ns : mean_ns + (value_ns - mean_ns) / 4;
  }

  std::int64_t decode_ns_ = 0, infer_image_ns_ = 0;
};

}  // namespace rtd::detector
