// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

enum class MapFileDefect {
  kNotAMap,  ///< another kind of file
  kVersion,  ///< a map file of another version of the format
  kDamaged,  ///< cut, changed, or not what a map can be
};

/// A file cannot be read as a map: what() names the place, the cause and the fix.
class MapFileError : public std::runtime_error {
 public:
  MapFileError(MapFileDefect defect, const std::string& what) : std::runtime_error(what), defect_(defect) {}
  MapFileDefect defect() const { return defect_; }

 private:
  MapFileDefect defect_;
};

}  // namespace rtd::slam

/// The numbers of a map file, docs/map_file.md, and what its values must be: checked before they are written and after
/// they are read. All little-endian.
namespace rtd::slam::map_format {

constexpr std::string_view kMagic{"\x89RTDMAP\n", 8};
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kPreambleBytes = 16;  ///< magic, version, CRC of both: the same in every version

/// What a block holds; the four letters as in the file.
enum class BlockTag : std::uint32_t {
  kHead = 0x44414548,       ///< "HEAD"
  kLandmarks = 0x444E414C,  ///< "LAND"
  kKeyframes = 0x4659454B,  ///< "KEYF"
  kRemoved = 0x564D4552,    ///< "REMV"
  kLoops = 0x504F4F4C,      ///< "LOOP"
  kEnd = 0x53444E45,        ///< "ENDS"
};
constexpr std::size_t kBlockHeadBytes = 8;       ///< tag, size of the payload
constexpr std::size_t kBlockBytes = 1 << 20;     ///< a writer ends a block behind the record that reaches this
constexpr std::size_t kMaxBlockBytes = 4 << 20;  ///< a reader refuses larger ones

constexpr std::size_t kTransformBytes = 12 * 8;
constexpr std::size_t kLandmarkBytes = 4 + 10 * 8 + sizeof(msg::Descriptor) + 4 * 4;
constexpr std::size_t kObservationBytes = 2 + 4;
constexpr std::size_t kFeatureBytes = 5 * 4 + 2 + sizeof(msg::Descriptor);
/// Without covariance, observations and features.
constexpr std::size_t kKeyframeBytes = 3 * 4 + 3 * 2 + 2 * 8 + kTransformBytes + 2 * 8 + 1;
constexpr std::size_t kRemovedBytes = 2 * 4 + kTransformBytes;
constexpr std::size_t kLoopBytes = 3 * 4 + kTransformBytes;
constexpr double kMaxReadout_s = 1;  ///< of a frame
constexpr std::size_t kMaxCameras = 0xFFFF;
constexpr int kMaxImageSide_px = 16384;

/// The camera that a keyframe was seen with.
struct StoredCamera {
  vision::RgbdProjection projection;
  int width_px = 0, height_px = 0;

  bool is_of(const Frame& frame) const {
    const vision::RgbdProjection &p = projection, &q = frame.camera;
    return p.fx == q.fx && p.fy == q.fy && p.cx == q.cx && p.cy == q.cy && p.disparity_px_m == q.disparity_px_m &&
           width_px == frame.width_px && height_px == frame.height_px;
  }
};

/// Block HEAD: what the file holds.
struct Head {
  std::uint32_t keyframes = 0, landmarks = 0, removed = 0, loops = 0;
  KeyframeId next_keyframe = 0;
  LandmarkId next_landmark = 0;
  MapId next_map = 0;
  std::uint8_t probability_origin = 0;  ///< 0: mean of the observations; 1: of an earlier version
  std::vector<StoredCamera> cameras;
};

inline bool is_rigid(const Eigen::Isometry3d& T) {
  constexpr double kTolerance = 1e-6;
  const Eigen::Matrix3d R = T.linear();
  return T.translation().allFinite() && R.allFinite() &&
         (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kTolerance && R.determinant() > 0;
}

/// Finite, and no correlation beyond 1.
inline bool is_sound(const geometry::Matrix6d& covariance) {
  constexpr double kTolerance = 1e-9;
  if (!covariance.allFinite() || covariance.diagonal().minCoeff() < 0) return false;
  const geometry::Vector6d sigma = covariance.diagonal().cwiseSqrt();
  return ((covariance.cwiseAbs() - sigma * sigma.transpose()).array() <= kTolerance).all();
}

inline bool is_sound(const Landmark& landmark) {
  return landmark.position.allFinite() && landmark.normal.allFinite() && std::isfinite(landmark.min_distance_m) &&
         std::isfinite(landmark.max_distance_m) && landmark.min_distance_m >= 0 && landmark.max_distance_m >= 0 &&
         landmark.static_probability >= 0 && landmark.static_probability <= 1;
}

inline bool is_sound(const StoredCamera& camera) {
  const auto& [fx, fy, cx, cy, disparity_px_m] = camera.projection;
  const auto side = [](int px) { return px > 0 && px <= kMaxImageSide_px; };
  return std::isfinite(fx) && std::isfinite(fy) && std::isfinite(cx) && std::isfinite(cy) && fx > 1 && fy > 1 &&
         std::isfinite(disparity_px_m) && disparity_px_m > 0 && side(camera.width_px) && side(camera.height_px);
}

}  // namespace rtd::slam::map_format
