// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// "stamp file" of rgb.txt or depth.txt.
struct StampedFile {
  std::int64_t stamp_ns = 0;
  std::string file;  ///< relative to the folder
};

/// A colour image with its depth image.
struct FilePair {
  StampedFile color, depth;
};

/// The pairs of a sequence in playing order and what was left out on the way.
struct PairList {
  std::vector<FilePair> pairs;  ///< colour stamps strictly increasing
  std::vector<SkippedInput> skipped;
  std::uint64_t depth_alone = 0;  ///< depth images that no colour image was found for
};

/// The pairs of a TUM folder: associations.txt unchanged when there is one (a depth image may occur twice there),
/// else rgb.txt and depth.txt associated. Throws SourceError for a missing folder or list and for stamps that are not
/// finite.
PairList read_pairs(const std::filesystem::path& folder, std::int64_t tolerance_ns = kPairingToleranceNs);

/// A folder in TUM's layout. Opening reads the lists, the calibration, the ground truth and the first good frame.
class TumSource final : public PlayedSource {
 public:
  struct Options {
    bool masks = false;  ///< also read mask/<colour file name>.png: pixels of moving objects
    std::int64_t tolerance_ns = kPairingToleranceNs;  ///< between the stamps of colour and depth
  };
  /// Throws SourceError: no sequence there, no calibration, no good frame, frames larger than the frame type.
  TumSource(std::string uri, std::filesystem::path folder, Options options);

  geometry::Trajectory groundtruth() const override { return groundtruth_; }
  std::optional<Eigen::Isometry3d> true_pose(std::int64_t stamp_ns) const override {
    return geometry::pose_at(groundtruth_, stamp_ns, kTrueWithinNs);
  }

 private:
  std::optional<std::int64_t> advance() override;
  std::optional<SourceFrame> decode() override;
  std::optional<SkippedInput> check_sizes(const FilePair& pair, const cv::Mat& color, const cv::Mat& depth) const;
  cv::Mat read_mask(const FilePair& pair) const;

  std::filesystem::path folder_;
  Options options_;
  std::vector<FilePair> pairs_;
  std::size_t next_pair_ = 0;
  geometry::Trajectory groundtruth_;
};

}  // namespace rtd::camera
