// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/ros.hpp"

namespace rtd::recorder {

/// The pixels of people in an image.
struct People {
  cv::Mat mask;      ///< CV_8UC1, 255 = a person; empty: none
  int block_px = 0;  ///< side of the squares that make the largest of them unrecognisable
};

/// Where people are in the images of one camera: in the detector's boxes, and where its masks are larger than these.
/// The boxes of all batches within kWithinNs of an image count, so that a person whom one batch misses is still found.
/// Not thread-safe.
class PeopleRegions {
 public:
  static constexpr std::int64_t kWithinNs = 250'000'000;

  /// Keeps the newest batches only.
  explicit PeopleRegions(std::size_t most_batches = std::numeric_limits<std::size_t>::max()) : most_(most_batches) {}

  void add(const msg::Detection2DArray& batch);
  void add_masks(const msg::Image& labels);
  /// The size of an image that the detector gets.
  void saw(cv::Size image_px) { image_px_ = image_px; }

  bool empty() const { return batches_.empty(); }
  /// All that can be known of an image has come.
  bool settled(std::int64_t stamp_ns) const;
  /// Empty when it is not known: no batch is of this image, nor of images within kWithinNs before and after it.
  std::optional<People> at(std::int64_t stamp_ns, cv::Size image_px) const;
  /// Whether another image is one of the detector's: it has the frame of its batches, and the size of its images.
  bool concern(const std::string& frame_id, cv::Size image_px) const;

 private:
  struct Batch {
    std::vector<cv::Rect2d> people_px;
    std::vector<bool> cells;  ///< of the masks, any person; empty: none
    cv::Size cells_size;
    bool has_boxes = false;  ///< the detections have come, not just masks
  };
  using Batches = std::map<std::int64_t, Batch>;  ///< by stamp

  Batch& batch_of(std::int64_t stamp_ns);
  bool known(std::int64_t stamp_ns) const;

  std::size_t most_;
  Batches batches_;
  std::deque<std::int64_t> order_;  ///< as they came
  std::optional<std::int64_t> newest_ns_;
  std::string frame_id_;
  cv::Size image_px_;
};

}  // namespace rtd::recorder
