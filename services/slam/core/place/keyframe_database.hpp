// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "services/slam/core/map/map.hpp"
#include "services/slam/core/place/vocabulary.hpp"

namespace rtd::slam {

/// A keyframe that shares words with an image.
struct ScoredKeyframe {
  KeyframeId keyframe = kNoKeyframe;
  float score = 0;  ///< similarity(), (0, 1]
};

/// Which keyframes show which words. Same order of calls, same answers. One thread at a time.
class KeyframeDatabase {
 public:
  /// A keyframe is added once; a second time replaces its words.
  void add(KeyframeId keyframe, BagOfWords bag);
  /// Unknown keyframes are passed over.
  void remove(KeyframeId keyframe);
  /// Null when not in the database. Valid until it is removed.
  const BagOfWords* find(KeyframeId keyframe) const;
  std::size_t size() const { return bags_.size(); }

  /// All keyframes that share a word with `bag` and that `admitted` (empty: all) lets pass, best first, then by id.
  std::vector<ScoredKeyframe> query(const BagOfWords& bag, const std::function<bool(KeyframeId)>& admitted = {}) const;

 private:
  struct Posting {
    KeyframeId keyframe;
    float weight;
  };
  std::map<KeyframeId, BagOfWords> bags_;
  std::vector<std::vector<Posting>> postings_;  ///< per word, by ascending keyframe
  mutable std::vector<float> scores_;           ///< per keyframe id, zero between two queries
};

/// A place: a keyframe that looks like the image, and its neighbours that do so too.
struct PlaceCandidate {
  KeyframeId keyframe = kNoKeyframe;  ///< the best of the group
  MapId map = 0;
  float score = 0;                ///< of the keyframe
  float group_score = 0;          ///< summed over the group
  std::vector<KeyframeId> group;  ///< a hit and its best covisible keyframes, whether they look alike or not
};

struct PlaceQuery {
  std::function<bool(KeyframeId)> admitted;  ///< keyframes that may be candidates; empty: all
  float min_score = 0;                       ///< of a keyframe; the similarity of two views of one place varies
  float min_group_ratio = 0.75F;             ///< of the best group's score
  std::size_t max_candidates = 10;
};

/// Covisibility-consistent candidates: hits are grouped with their covisible keyframes, the sums are compared, each
/// group is represented by its best keyframe. Best group first. docs/theory/place_recognition.md Eq. (4).
std::vector<PlaceCandidate> find_places(const KeyframeDatabase& database, const Map& map, const BagOfWords& bag,
                                        const PlaceQuery& query = {});

}  // namespace rtd::slam
