// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/vision/detection.hpp"

namespace rtd::test_support {

/// What is done to the images of any source for a time, seconds after its first frame. Poses stay true.
struct ImageFault {
  enum class Kind {
    kOcclude,  ///< something opaque and textured moves 0.8 m before the camera and covers `amount` of the view
    kPerson,   ///< the same, but a detector recognises it as a person
    kDark,     ///< colour keeps 2 % of its brightness; depth stays
    kBlur,     ///< colour is smeared over `amount` px along its rows
  };
  Kind kind = Kind::kOcclude;
  double amount = 0;
  double begin_s = 0, end_s = 0;
};

/// Applies faults to frames, in their order. The same frames give the same bits.
class ImageFaults {
 public:
  explicit ImageFaults(std::vector<ImageFault> faults) : faults_(std::move(faults)) {}

  /// Copies what it changes. What occludes is in the mask too, where the source has one.
  void apply(camera::SourceFrame& frame);
  /// What a detector finds in a changed frame, if it finds `boxes` in the frame as it was: nothing in the dark, nothing
  /// that is hidden by half, and a person where one occludes.
  std::vector<vision::Detection> seen(const camera::SourceFrame& frame, std::vector<vision::Detection> boxes);

 private:
  double seconds(const camera::SourceFrame& frame);

  std::vector<ImageFault> faults_;
  std::optional<std::int64_t> first_ns_;
};

}  // namespace rtd::test_support
