// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// A landmark as the tracker needs it.
struct LocalLandmark {
  LandmarkId id = kNoLandmark;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< p_world, m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double min_distance_m = 0, max_distance_m = 0;
  double static_probability = 1.0;
  bool in_question = false;
  bool witness = false;
  UnmeasuredDepth unmeasured;
  int observation_weight = 0;
  msg::Descriptor descriptor{};
  std::uint32_t first_observer = 0, observers = 0;  ///< range in LocalMap::observers
};

/// A keyframe as the tracker needs it.
struct LocalKeyframe {
  KeyframeId id = kNoKeyframe;
  FramePtr frame;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<LandmarkId> landmarks;                            ///< per feature
  std::optional<geometry::Matrix6d> covariance = std::nullopt;  ///< Keyframe::covariance
};

/// The part of the map around one keyframe, copied out of it: immutable, so that tracking needs no lock.
struct LocalMap {
  std::uint64_t version = 0;                         ///< counts the snapshots of one mapper
  std::vector<LocalKeyframe> keyframes;              ///< the centre first, then by landmarks in common
  std::vector<LocalLandmark> landmarks;              ///< ordered by id
  std::vector<std::uint32_t> observers;              ///< indices into keyframes
  MapId map = 0;                                     ///< component of the centre
  std::size_t component_keyframes = 0;               ///< size of that component
  std::size_t components = 0;                        ///< of the whole map
  std::size_t map_keyframes = 0, map_landmarks = 0;  ///< size of the whole map, all components

  const LocalLandmark* find_landmark(LandmarkId id) const;
  const LocalKeyframe* find_keyframe(KeyframeId id) const;
  /// Landmarks of a keyframe that more than one view confirms; in a young map one view with depth is enough.
  int confirmed_landmarks(const LocalKeyframe& keyframe) const;
};
using LocalMapPtr = std::shared_ptr<const LocalMap>;

/// Copies `centre`, the keyframes that share landmarks with it and their best neighbours (at most `max_keyframes`), and
/// all landmarks that these see.
LocalMapPtr make_local_map(const Map& map, KeyframeId centre, std::uint64_t version, std::size_t max_keyframes = 60);

}  // namespace rtd::slam
