// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/place/keyframe_database.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace rtd::slam {
namespace {

constexpr std::size_t kMaxHits = 100;  ///< the best ones are grouped; the rest lies in their groups or far behind
constexpr std::size_t kGroupNeighbours = 10;  ///< covisible keyframes that make a group

bool ranks_before(const ScoredKeyframe& a, const ScoredKeyframe& b) {
  return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
}

template <typename Postings>
auto find_posting(Postings& postings, KeyframeId keyframe) {
  return std::ranges::lower_bound(postings, keyframe, {}, [](const auto& posting) { return posting.keyframe; });
}

}  // namespace

void KeyframeDatabase::add(KeyframeId keyframe, BagOfWords bag) {
  remove(keyframe);
  if (!bag.words.empty() && bag.words.back().word >= postings_.size()) postings_.resize(bag.words.back().word + 1);
  for (const WeightedWord& word : bag.words) {
    std::vector<Posting>& postings = postings_[word.word];
    postings.insert(find_posting(postings, keyframe), {keyframe, word.weight});
  }
  if (keyframe >= scores_.size()) scores_.resize(keyframe + 1, 0.0F);
  bags_.emplace(keyframe, std::move(bag));
}

void KeyframeDatabase::remove(KeyframeId keyframe) {
  const auto bag = bags_.find(keyframe);
  if (bag == bags_.end()) return;
  for (const WeightedWord& word : bag->second.words) {
    std::vector<Posting>& postings = postings_[word.word];
    postings.erase(find_posting(postings, keyframe));
  }
  bags_.erase(bag);
}

const BagOfWords* KeyframeDatabase::find(KeyframeId keyframe) const {
  const auto bag = bags_.find(keyframe);
  return bag == bags_.end() ? nullptr : &bag->second;
}

std::vector<ScoredKeyframe> KeyframeDatabase::query(const BagOfWords& bag,
                                                    const std::function<bool(KeyframeId)>& admitted) const {
  std::vector<KeyframeId> touched;
  for (const WeightedWord& word : bag.words) {
    if (word.word >= postings_.size()) break;  // ascending: no keyframe shows the rest
    for (const Posting& posting : postings_[word.word]) {
      float& score = scores_[posting.keyframe];
      if (score == 0) touched.push_back(posting.keyframe);
      score += std::min(word.weight, posting.weight);
    }
  }
  std::vector<ScoredKeyframe> hits;
  for (const KeyframeId keyframe : touched) {
    const float score = std::exchange(scores_[keyframe], 0.0F);
    if (!admitted || admitted(keyframe)) hits.push_back({keyframe, score});
  }
  std::sort(hits.begin(), hits.end(), ranks_before);
  return hits;
}

std::vector<PlaceCandidate> find_places(const KeyframeDatabase& database, const Map& map, const BagOfWords& bag,
                                        const PlaceQuery& query) {
  std::vector<ScoredKeyframe> hits = database.query(bag, query.admitted);
  std::erase_if(hits, [&](const ScoredKeyframe& hit) { return hit.score < query.min_score; });
  if (hits.size() > kMaxHits) hits.resize(kMaxHits);
  std::unordered_map<KeyframeId, float> score_of;
  for (const ScoredKeyframe& hit : hits) score_of.emplace(hit.keyframe, hit.score);

  std::map<KeyframeId, PlaceCandidate> places;  // by representative: the groups of two neighbours are one place
  float best_group = 0;
  for (const ScoredKeyframe& hit : hits) {
    std::vector<KeyframeId> group = map.best_covisible(hit.keyframe, kGroupNeighbours);
    group.insert(group.begin(), hit.keyframe);
    ScoredKeyframe best = hit;
    float sum = 0;
    for (const KeyframeId member : group) {
      const auto score = score_of.find(member);
      if (score == score_of.end()) continue;
      sum += score->second;
      if (ranks_before({member, score->second}, best)) best = {member, score->second};
    }
    best_group = std::max(best_group, sum);
    PlaceCandidate& place = places[best.keyframe];
    if (sum <= place.group_score) continue;
    place = {best.keyframe, map.find_keyframe(best.keyframe)->map, best.score, sum, std::move(group)};
  }

  std::vector<PlaceCandidate> candidates;
  for (auto& [keyframe, place] : places) {
    if (place.group_score >= query.min_group_ratio * best_group) candidates.push_back(std::move(place));
  }
  std::ranges::stable_sort(candidates, std::greater{}, &PlaceCandidate::group_score);
  if (candidates.size() > query.max_candidates) candidates.resize(query.max_candidates);
  return candidates;
}

}  // namespace rtd::slam
