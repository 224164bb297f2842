// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// TUM's tolerance for pairing colour and depth stamps.
inline constexpr std::int64_t kPairingToleranceNs = 20'000'000;

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
};

/// The pairs of a TUM folder: associations.txt unchanged when there is one (a depth image may occur twice there),
/// else rgb.txt and depth.txt associated. Throws SourceError for a missing folder or list and for stamps that are not
/// finite.
PairList read_pairs(const std::filesystem::path& folder);

}  // namespace rtd::camera
