// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <vector>

#include "common/msg/ros.hpp"
#include "common/service/log.hpp"
#include "common/vision/detection.hpp"
#include "services/detector/core/person_segmenter.hpp"

namespace rtd::detector {

/// Labels as an image: mono8, a pixel for each kMaskStepPx of an image of `width_px` x `height_px`. No masks: all 0.
msg::Image to_message(const vision::PersonMasks& masks, cv::Size image_px, const msg::Header& header);

/// How many masks of a frame there is time for: as many as the camera leaves after the boxes, but at least one. Times
/// are means, newer ones count more. Not thread-safe.
class MaskBudget {
 public:
  /// Every image of the camera, also those that are not worked on.
  void saw_image(std::int64_t stamp_ns);
  void took(double boxes_ms, double masks_ms, int fresh);
  /// Of at most `all`; all of them while nothing is known.
  int fresh_at_most(int all) const;

 private:
  std::int64_t last_stamp_ns_ = 0;
  double gap_ms_ = 0, boxes_ms_ = 0, mask_ms_ = 0;  ///< 0: not known
};

/// An image with what the detector found in it.
struct BoxedImage {
  const cv::Mat& color_bgr;
  const std::vector<vision::Detection>& detections;
  double boxes_ms = 0;  ///< what the detections took
};

/// The masks of a service: a network for each of its workers, which share the counters. Boxes never suffer from a
/// network that fails: their masks are then empty.
class MaskStage {
 public:
  /// Loads the networks; on the CPU where the engine asked for is not there. Throws ModelError. `in_time`: as many
  /// fresh masks as there is time for (realtime); otherwise all, so that the same images give the same masks.
  MaskStage(MaskConfig config, std::size_t workers, bool in_time);

  /// Thread-safe, as the others below.
  void saw_image(std::int64_t stamp_ns);
  /// One call at a time for each worker.
  vision::PersonMasks segment(std::size_t worker, const BoxedImage& boxed);

  struct Counters {
    std::uint64_t frames = 0;
    std::uint64_t masks = 0;  ///< persons with a mask, of all frames
    double total_ms = 0;
    double mean_ms() const { return frames == 0 ? 0 : total_ms / static_cast<double>(frames); }
  };
  Counters counters() const;
  const PersonSegmenter& segmenter() const { return *segmenters_.front(); }

 private:
  int fresh_at_most() const;
  void count(const vision::PersonMasks& masks, int fresh, double boxes_ms, double masks_ms);

  std::vector<std::unique_ptr<PersonSegmenter>> segmenters_;
  const bool in_time_;
  mutable std::mutex mutex_;
  MaskBudget budget_;
  Counters counters_;
  service::RateLimit failure_log_{std::chrono::seconds(10)};
};

}  // namespace rtd::detector
