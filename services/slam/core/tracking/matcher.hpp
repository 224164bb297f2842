// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "services/slam/core/map/frame.hpp"

namespace rtd::slam {

/// A point that should be visible in an image: where to look for it and what it looks like.
struct SearchPoint {
  vision::SearchWindow window;
  float inverse_depth_per_m = 0;  ///< predicted 1/z, compared with the feature's depth where there is one
  const msg::Descriptor* descriptor = nullptr;
  float angle_rad = 0;    ///< orientation where it was last seen; used by RotationCheck::kOn
  std::uint32_t tag = 0;  ///< the caller's index
};

enum class RotationCheck : std::uint8_t { kOff, kOn };

struct MatchRules {
  int max_hamming = 100;   ///< of 256 bits
  double max_ratio = 1.0;  ///< best / second best of the same octave; 1 = no such check
  RotationCheck rotation = RotationCheck::kOff;
  double disparity_px_m = 40.0;  ///< depth gate: |b/z - b/depth| must be within the search radius
};

struct Match {
  std::uint32_t feature = 0;  ///< in the frame
  std::uint32_t tag = 0;      ///< of the search point, or feature of the other frame
  int hamming = 0;
};

/// Guided matching: for each point the most similar feature in its window. A feature goes to the point that it is most
/// similar to; features marked in `taken` (per feature; may be empty) are left alone. Ordered by feature.
std::vector<Match> match_projected(const Frame& frame, std::span<const SearchPoint> points,
                                   const std::vector<char>& taken, const MatchRules& rules);

/// Unguided matching of chosen features of `other` with all of `frame`: mutual nearest with ratio and rotation check.
/// For tracking after a jump and for recovery; quadratic. `tag` is the feature in `other`.
std::vector<Match> match_by_descriptor(const Frame& frame, const Frame& other,
                                       std::span<const std::uint32_t> other_features, const MatchRules& rules);

/// Keeps the matches whose change of orientation agrees with the crowd's: the three fullest of 30 bins.
std::vector<Match> keep_consistent_rotation(const std::vector<Match>& matches, std::span<const float> change_rad);

/// A world point in an image.
struct Projection {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double z_m = 0;  ///< depth along the optical axis
};

/// Where `p_world` appears in `frame` seen from `T_camera_world`; empty behind the camera or outside the image.
std::optional<Projection> project(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                                  const Eigen::Vector3d& p_world);

/// What decides whether and how large a landmark appears.
struct LandmarkView {
  Eigen::Vector3d position, normal;
  double min_distance_m, max_distance_m;
};

struct PredictedView {
  Projection projection;
  int octave = 0;
  double view_cosine = 1;  ///< of the angle between this ray and the landmark's mean ray
};

/// Viewing angles beyond this cosine (60 degrees) are not expected to look alike.
inline constexpr double kMinViewCosine = 0.5;

/// Whether a landmark should be visible and in which octave: inside the image, within its distance range, seen from a
/// similar side. docs/theory/tracking.md Eq. (5).
std::optional<PredictedView> predict_view(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                                          const Eigen::Isometry3d& T_camera_world, const LandmarkView& landmark);

/// Window around a predicted view, octaves [octave - 1, octave].
SearchPoint make_search_point(const PredictedView& view, double radius_px, const msg::Descriptor& descriptor,
                              std::uint32_t tag);

}  // namespace rtd::slam
