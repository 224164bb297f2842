// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <stdexcept>

#include "services/slam/core/store/block_io.hpp"
#include "services/slam/core/store/map_format.hpp"
#include "services/slam/core/store/map_reader.hpp"

namespace rtd::slam::map_format {

/// A record that cannot be part of a map; what() names it and why.
class Unsound : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Block HEAD. Throws Unsound or ros::WireError, as all that follows.
Head read_head(FieldReader fields);

/// Puts the contents of a map together from the records of its file and checks every value and cross reference.
class ContentsBuilder {
 public:
  /// `file_bytes` bounds the memory that the contents may need.
  ContentsBuilder(const Head& head, StoredFeatures features, std::uint64_t file_bytes);

  /// In this order: all landmarks, all keyframes, all removed keyframes.
  void add_landmark(FieldReader& fields);
  void add_keyframe(FieldReader& fields);
  void add_removed(FieldReader& fields);
  /// The contents; the builder is empty then.
  MapContents finish();

 private:
  struct SeenLandmark {
    std::uint32_t feature, landmark;  ///< indices
  };
  std::shared_ptr<Frame> make_frame(const StoredCamera& camera);
  std::vector<SeenLandmark> read_observations(FieldReader& fields, std::uint16_t count, Keyframe& keyframe);
  void read_features(FieldReader& fields, const Keyframe& keyframe, Frame& frame);
  void make_grid(Frame& frame);
  void check_parent(const std::string& name, const Keyframe& keyframe);
  void check_landmarks() const;
  bool is_known(KeyframeId id) const;
  void reserve_memory(std::uint64_t bytes, const char* what);

  const Head head_;
  const StoredFeatures features_;
  std::uint64_t memory_left_;
  MapContents contents_;
  std::set<MapId> origins_;  ///< maps whose first keyframe was seen
};

}  // namespace rtd::slam::map_format
