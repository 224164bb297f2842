// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/camera/calibration.hpp"
#include "common/camera/folder/layouts.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/image_files.hpp"
#include "common/vision/depth_registration.hpp"

namespace rtd::camera {

/// A folder of colour and depth in a known layout (layouts.hpp). Opening reads the lists, the first images, the
/// calibration, the ground truth and the first good frame, and says in info().notes what was taken for what.
class FolderSource final : public PlayedSource {
 public:
  struct Options {
    bool masks = false;    ///< also read mask/<colour file name>.png: pixels of moving objects
    bool outside = false;  ///< images and other files may lie outside the folder
    std::int64_t tolerance_ns = kPairingToleranceNs;  ///< between the stamps of colour and depth
    CalibrationRequest calibration;                   ///< with fps: frames are counted, stamps of lists do not matter
  };
  /// Throws SourceError: no sequence there, no calibration, no good frame, frames larger than the frame type.
  FolderSource(std::string uri, const std::filesystem::path& folder, Options options);

  geometry::Trajectory groundtruth() const override { return groundtruth_; }
  std::optional<Eigen::Isometry3d> true_pose(std::int64_t stamp_ns) const override {
    return geometry::pose_at(groundtruth_, stamp_ns, kTrueWithinNs);
  }

 private:
  /// The first images that can be read; empty where none can.
  struct FirstImages {
    std::optional<cv::Size> color_px;
    cv::Mat depth;  ///< CV_16UC1 or CV_32FC1
  };

  std::optional<std::int64_t> advance() override;
  std::optional<SourceFrame> decode() override;
  bool is_there() const override;

  void read_pairs();
  FirstImages look_at_first_images() const;
  void calibrate(const FirstImages& first);
  void fit(geometry::CameraModel& camera, cv::Size image_px);
  std::optional<Calibration> calibration_of_files(const FirstImages& first) const;
  void choose_depth_unit(const Calibration& calibration, const FirstImages& first);
  void choose_float_unit(const cv::Mat& values);
  void align_depth(const FirstImages& first);
  void set_times(const Calibration& calibration);
  void note(std::string text) { info_.notes.push_back(std::move(text)); }

  ImageRead read_depth_units(const std::string& file) const;
  cv::Mat read_mask(const FilePair& pair) const;

  Options options_;
  FolderContents contents_;
  PairList list_;
  std::size_t next_pair_ = 0;
  double float_step_ = 0;                ///< of depth in floats: what becomes a unit, in the unit of the floats
  bool y_up_ = false, rotated_ = false;  ///< rotated_: is_rotated()
  std::optional<vision::DepthRegistration> registration_;
  cv::Size large_px_;  ///< of colour images that are scaled down to the camera's size
  geometry::Trajectory groundtruth_;
};

}  // namespace rtd::camera
