// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {
namespace {

/// Counts for one keyframe after another the landmarks that it shares with each other one. Ids may have wide gaps.
class SharedLandmarks {
 public:
  explicit SharedLandmarks(const std::vector<Keyframe>& keyframes) : counts_(keyframes.size()) {
    index_of_.reserve(keyframes.size());
    for (const Keyframe& keyframe : keyframes) index_of_.emplace(keyframe.id, index_of_.size());
  }

  void count(const Landmark& landmark, KeyframeId keyframe) {
    for (const Observation& observation : landmark.observations) {
      if (observation.keyframe == keyframe) continue;
      int& count = counts_[index_of_.at(observation.keyframe)];
      if (count++ == 0) found_.emplace_back(observation.keyframe, &count);
    }
  }
  std::map<KeyframeId, int> take() {
    std::sort(found_.begin(), found_.end());
    std::map<KeyframeId, int> covisible;
    for (const auto& [other, count] : found_) covisible.emplace_hint(covisible.end(), other, std::exchange(*count, 0));
    found_.clear();
    return covisible;
  }

 private:
  std::unordered_map<KeyframeId, std::size_t> index_of_;
  std::vector<int> counts_;
  std::vector<std::pair<KeyframeId, int*>> found_;
};

}  // namespace

Map::Map(MapContents contents)
    : removed_(contents.removed.begin(), contents.removed.end()),
      loops_(std::move(contents.loops)),
      next_map_(contents.next_map),
      next_keyframe_(contents.next_keyframe),
      next_landmark_(contents.next_landmark) {
  for (Landmark& landmark : contents.landmarks) {
    const LandmarkId id = landmark.id;
    landmark.witness = true;  // what stood there for a moment has not been kept
    landmarks_.emplace(id, std::move(landmark));
  }
  SharedLandmarks shared(contents.keyframes);
  for (Keyframe& keyframe : contents.keyframes) {
    for (const LandmarkId landmark : keyframe.landmarks) {
      if (landmark != kNoLandmark) shared.count(landmarks_.at(landmark), keyframe.id);
    }
    keyframe.covisible = shared.take();
    if (!keyframe.is_origin()) keyframe_at(keyframe.parent).children.push_back(keyframe.id);
    ++component_sizes_[keyframe.map];
    const KeyframeId id = keyframe.id;
    keyframe_index_.add(id, &keyframes_.emplace_hint(keyframes_.end(), id, std::move(keyframe))->second);
  }
}

}  // namespace rtd::slam
