// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/camera/folder/frame_lists.hpp"

namespace rtd::camera {

/// A number of a frame is kept as so many seconds, so that lists with numbers in place of times read alike.
inline constexpr std::int64_t kNumberNs = 1'000'000'000;

/// What the names of images say.
enum class FrameNames { kNeither, kNumbers, kTimes };

/// Files with the times or numbers (in kNumberNs) of their names, in the order given.
struct NamedFrames {
  FrameNames kind = FrameNames::kNeither;
  std::vector<StampedFile> files;
};

/// Times where all names have one, else numbers where all have a digit: the longest run of digits.
NamedFrames read_frame_names(const std::vector<std::string>& files);

}  // namespace rtd::camera
