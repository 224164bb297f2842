// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "services/slam/core/map/map.hpp"

/// The numbers of a map file, docs/map_file.md. All little-endian.
namespace rtd::slam::map_format {

constexpr std::string_view kMagic{"\x89RTDMAP\n", 8};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kPreambleBytes = 16;  ///< magic, version, CRC of both: the same in every version

/// What a block holds; the four letters as they stand in the file.
enum class BlockTag : std::uint32_t {
  kHead = 0x44414548,       ///< "HEAD"
  kLandmarks = 0x444E414C,  ///< "LAND"
  kKeyframes = 0x4659454B,  ///< "KEYF"
  kRemoved = 0x564D4552,    ///< "REMV"
  kEnd = 0x53444E45,        ///< "ENDS"
};
constexpr std::size_t kBlockHeadBytes = 8;       ///< tag, size of the payload
constexpr std::size_t kBlockBytes = 1 << 20;     ///< a writer ends a block behind the record that reaches this
constexpr std::size_t kMaxBlockBytes = 4 << 20;  ///< a reader refuses larger ones

constexpr std::size_t kTransformBytes = 12 * 8;
constexpr std::size_t kLandmarkBytes = 4 + 10 * 8 + sizeof(msg::Descriptor) + 4 * 4;
constexpr std::size_t kObservationBytes = 2 + 4;
constexpr std::size_t kFeatureBytes = 5 * 4 + 2 + sizeof(msg::Descriptor);
constexpr std::size_t kKeyframeBytes = 3 * 4 + 3 * 2 + 2 * 8 + kTransformBytes;  ///< without observations and features
constexpr std::size_t kRemovedBytes = 2 * 4 + kTransformBytes;
constexpr std::size_t kMaxCameras = 0xFFFF;
constexpr int kMaxImageSide_px = 16384;

/// The camera that a keyframe was seen with.
struct StoredCamera {
  vision::RgbdProjection projection;
  int width_px = 0, height_px = 0;
};

/// Block HEAD: what the file holds.
struct Head {
  std::uint32_t keyframes = 0, landmarks = 0, removed = 0;
  KeyframeId next_keyframe = 0;
  LandmarkId next_landmark = 0;
  MapId next_map = 0;
  ProbabilityRule probability_rule = ProbabilityRule::kMeanOfObservations;
  std::vector<StoredCamera> cameras;
};

}  // namespace rtd::slam::map_format
