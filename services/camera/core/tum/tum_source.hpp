// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "services/camera/core/calibration.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/tum/tum_lists.hpp"

namespace rtd::camera {

/// A folder in TUM's layout. Opening reads the lists, the calibration, the ground truth and the first good frame.
class TumSource final : public FrameSource {
 public:
  struct Options {
    bool masks = false;  ///< also read mask/<colour file name>.png: pixels of moving objects
  };
  /// Throws SourceError: no sequence there, no calibration, no good frame, frames larger than the frame type.
  TumSource(std::string uri, std::filesystem::path folder, Options options);

  std::optional<SourceFrame> next() override;
  std::uint64_t pass_over(std::int64_t stamp_ns) override;
  const SourceInfo& info() const override { return info_; }
  const SourceCounters& counters() const override { return skips_.counters(); }
  geometry::Trajectory groundtruth() const override { return groundtruth_; }
  std::vector<SkippedInput> take_skipped() override { return skips_.take(); }

 private:
  std::optional<SourceFrame> read_next();
  std::optional<SourceFrame> read_pair(const FilePair& pair);
  std::optional<SkippedInput> check_sizes(const FilePair& pair, const cv::Mat& color, const cv::Mat& depth) const;
  cv::Mat read_mask(const FilePair& pair) const;

  std::filesystem::path folder_;
  Options options_;
  SourceInfo info_;
  SkipLog skips_;
  std::vector<FilePair> pairs_;
  std::size_t next_pair_ = 0;
  geometry::Trajectory groundtruth_;
  std::optional<SourceFrame> first_;  ///< read while opening
};

}  // namespace rtd::camera
