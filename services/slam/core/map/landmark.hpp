// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <memory_resource>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/msg/features.hpp"

namespace rtd::slam {

using KeyframeId = std::uint32_t;
using LandmarkId = std::uint32_t;
using MapId = std::uint32_t;  ///< a component of the map: what one first keyframe grew to; 0 = the first
inline constexpr KeyframeId kNoKeyframe = std::numeric_limits<KeyframeId>::max();
inline constexpr LandmarkId kNoLandmark = std::numeric_limits<LandmarkId>::max();

/// Landmark `landmark` is feature `feature` of keyframe `keyframe`.
struct Observation {
  KeyframeId keyframe = kNoKeyframe;
  std::uint32_t feature = 0;
};

struct Landmark {
  LandmarkId id = kNoLandmark;
  KeyframeId reference = kNoKeyframe;                  ///< keyframe that scale is measured from
  KeyframeId first_keyframe = kNoKeyframe;             ///< keyframe that made it
  int observation_weight = 0;                          ///< as ORB-SLAM2 counts: an observation with depth is two
  std::uint32_t visible = 1, found = 1;                ///< frames that should have seen it / did
  bool appearance_is_current = false;                  ///< descriptor and mean probability fit the observations
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< p_world, m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< mean viewing direction, camera -> landmark, world frame
  double min_distance_m = 0, max_distance_m = 0;       ///< from where the pyramid can show it
  double static_probability = 1.0;                     ///< mean over the features that it was seen as
  bool in_question = false;                            ///< all of them were: see static_weight()
  /// Seen to rest: by two keyframes that witnesses carried, at least half a second apart.
  bool witness = false;
  std::int64_t carried_since_ns = 0;      ///< stamp of the first such keyframe; 0: none
  msg::Descriptor descriptor{};           ///< the observation that is nearest to all others
  std::vector<Observation> observations;  ///< ordered by keyframe, one per keyframe
};

/// What is not known of where a landmark is that no keyframe measured the depth of.
struct UnmeasuredDepth {
  double sigma_per_m = 0;                               ///< of the inverse depth; 0: it was measured
  Eigen::Vector3d seen_from = Eigen::Vector3d::Zero();  ///< camera that saw it first, world frame, m

  /// By how much it may be seen elsewhere in the image than where it is expected, from `camera`. docs/theory/mapping.md
  /// Eq. (10).
  double sigma_px(const Eigen::Vector3d& camera, double fx_px) const {
    return sigma_per_m > 0 ? fx_px * sigma_per_m * (camera - seen_from).norm() : 0;
  }
};

/// Whether a keyframe measured how far away it is; otherwise triangulation or an assumption placed it.
inline bool has_measured_depth(const Landmark& landmark) {
  return landmark.observation_weight > static_cast<int>(landmark.observations.size());
}

/// What a landmark says about a pose that sees it as `feature`: the smaller of their probabilities. Where the feature
/// is in question, hardly anything, until other keyframes have seen the landmark when it was not.
inline double static_weight(const msg::Feature& feature, double landmark_probability, bool landmark_in_question) {
  constexpr double kInQuestion = 1e-3;  // with more, a carried thing near by outweighs a wall far away
  if ((feature.flags & msg::kFeatureInQuestion) == 0)
    return std::min<double>(feature.static_probability, landmark_probability);
  return landmark_in_question ? kInQuestion : landmark_probability;
}

/// What tracking gathered about a landmark since the last keyframe.
struct LandmarkStatistics {
  LandmarkId landmark = kNoLandmark;
  std::uint32_t visible = 0, found = 0;  ///< frames that should have seen it / did
};
using StatisticsById = std::pmr::unordered_map<LandmarkId, LandmarkStatistics>;

/// Values by id, for ids that count up and most of which are soon removed: a lookup is two loads, and pages without
/// a value take no memory, wherever the ids lie. `kNone` is the value of ids that have none.
template <class Value, Value kNone>
class PagedIndex {
 public:
  Value find(std::uint32_t id) const {
    const std::size_t page = id / kPageIds;
    return page >= pages_.size() || pages_[page] == nullptr ? kNone : pages_[page]->values[id % kPageIds];
  }
  /// `id` must have no value yet, `value` must not be kNone.
  void add(std::uint32_t id, Value value) {
    const std::size_t page = id / kPageIds;
    if (page >= pages_.size()) pages_.resize(page + 1);
    if (pages_[page] == nullptr) {
      pages_[page] = std::make_unique<Page>();
      pages_[page]->values.fill(kNone);
    }
    pages_[page]->values[id % kPageIds] = value;
    ++pages_[page]->used;
  }
  /// `id` must have a value.
  void erase(std::uint32_t id) {
    std::unique_ptr<Page>& page = pages_[id / kPageIds];
    page->values[id % kPageIds] = kNone;
    if (--page->used == 0) page.reset();
  }
  /// Ids that have a value, ascending.
  template <class Visitor>
  void for_each_id(Visitor&& visit) const {
    for (std::size_t page = 0; page < pages_.size(); ++page) {
      for (std::size_t i = 0; pages_[page] != nullptr && i < kPageIds; ++i) {
        if (pages_[page]->values[i] != kNone) visit(static_cast<std::uint32_t>(page * kPageIds + i));
      }
    }
  }

 private:
  static constexpr std::size_t kPageIds = 1024;
  struct Page {
    std::array<Value, kPageIds> values;
    std::size_t used = 0;
  };
  std::vector<std::unique_ptr<Page>> pages_;  ///< by id / kPageIds; null where no id has a value
};

/// The landmarks of a map by id, in blocks whose places are used again: memory follows the landmarks that live. A
/// landmark stays where it is while it lives.
class LandmarkStore {
 public:
  /// Takes a landmark in; `id` must not be in use.
  Landmark& emplace(LandmarkId id, Landmark landmark);
  void erase(LandmarkId id);

  /// Null when unknown.
  const Landmark* find(LandmarkId id) const {
    const Slot slot = slots_.find(id);
    return slot == kNoSlot ? nullptr : &blocks_[slot / kBlockLandmarks][slot % kBlockLandmarks];
  }
  Landmark* find(LandmarkId id) {
    const Slot slot = slots_.find(id);
    return slot == kNoSlot ? nullptr : &blocks_[slot / kBlockLandmarks][slot % kBlockLandmarks];
  }
  /// Throws std::out_of_range when unknown.
  Landmark& at(LandmarkId id);
  std::size_t size() const { return size_; }
  std::vector<LandmarkId> ids() const;  ///< ascending

 private:
  using Slot = std::uint32_t;
  static constexpr Slot kNoSlot = std::numeric_limits<Slot>::max();
  static constexpr std::size_t kBlockLandmarks = 256;

  PagedIndex<Slot, kNoSlot> slots_;
  std::vector<std::unique_ptr<Landmark[]>> blocks_;
  std::vector<Slot> free_;
  std::size_t size_ = 0;
};

}  // namespace rtd::slam
