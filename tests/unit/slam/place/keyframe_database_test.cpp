// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/place/keyframe_database.hpp"

#include <gmock/gmock.h>

#include <random>

namespace rtd::slam {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

BagOfWords random_bag(std::mt19937_64& random, WordId first, WordId count) {
  BagOfWords bag;
  for (WordId word = first; word < first + count; ++word) {
    if (random() % 4 == 0) bag.words.push_back({word, static_cast<float>(1 + random() % 9)});
  }
  float sum = 0;
  for (const WeightedWord& word : bag.words) sum += word.weight;
  for (WeightedWord& word : bag.words) word.weight /= sum;
  return bag;
}

BagOfWords bag_of(std::vector<WordId> words) {
  BagOfWords bag;
  for (const WordId word : words) bag.words.push_back({word, 1.0F / static_cast<float>(words.size())});
  return bag;
}

std::vector<KeyframeId> ids(const std::vector<ScoredKeyframe>& hits) {
  std::vector<KeyframeId> ids;
  for (const ScoredKeyframe& hit : hits) ids.push_back(hit.keyframe);
  return ids;
}

TEST(KeyframeDatabase, scores_as_comparing_one_by_one_does) {
  std::mt19937_64 random(3);
  KeyframeDatabase database;
  std::map<KeyframeId, BagOfWords> bags;
  for (int step = 0; step < 500; ++step) {  // ids in any order, some go, some come again
    const auto id = static_cast<KeyframeId>(random() % 60);
    if (random() % 3 == 0) {
      database.remove(id);
      bags.erase(id);
    } else {
      bags[id] = random_bag(random, static_cast<WordId>(random() % 200), 80);
      database.add(id, bags[id]);
    }
  }
  ASSERT_EQ(database.size(), bags.size());
  for (int i = 0; i < 20; ++i) {
    const BagOfWords query = random_bag(random, static_cast<WordId>(random() % 200), 80);
    const auto hits = database.query(query);
    std::map<KeyframeId, float> found;
    for (const ScoredKeyframe& hit : hits) found[hit.keyframe] = hit.score;
    for (const auto& [id, bag] : bags) {
      const float expected = similarity(query, bag);
      EXPECT_NEAR(found.contains(id) ? found.at(id) : 0.0F, expected, 1e-5F);
    }
    for (std::size_t k = 1; k < hits.size(); ++k) EXPECT_GE(hits[k - 1].score, hits[k].score);
  }
}

TEST(KeyframeDatabase, forgets_what_is_removed_and_gives_the_same_hits_again) {
  KeyframeDatabase database;
  database.add(4, bag_of({1, 2, 3}));
  database.add(2, bag_of({1, 2, 3}));
  database.add(9, bag_of({3, 4}));
  EXPECT_THAT(ids(database.query(bag_of({1, 2, 3}))), ElementsAre(2, 4, 9));  // equal scores: by id
  EXPECT_THAT(ids(database.query(bag_of({1, 2, 3}))), ElementsAre(2, 4, 9));
  database.remove(2);
  database.remove(2);
  database.remove(77);
  EXPECT_THAT(ids(database.query(bag_of({1, 2, 3}))), ElementsAre(4, 9));
  EXPECT_EQ(database.find(2), nullptr);
  EXPECT_EQ(database.find(9)->words.size(), 2U);
  EXPECT_THAT(database.query(bag_of({500})), IsEmpty());
  EXPECT_THAT(database.query({}), IsEmpty());
}

TEST(KeyframeDatabase, leaves_out_what_is_not_admitted) {
  KeyframeDatabase database;
  for (KeyframeId id = 0; id < 6; ++id) database.add(id, bag_of({1, 2}));
  const auto hits = database.query(bag_of({1, 2}), [](KeyframeId id) { return id % 2 == 1; });
  EXPECT_THAT(ids(hits), ElementsAre(1, 3, 5));
}

FramePtr empty_frame(std::size_t features) {
  auto frame = std::make_shared<Frame>();
  frame->features.resize(features);
  return frame;
}

/// Two maps of keyframes in a row: 0-1-2-3 and 4-5; neighbours share 20 landmarks.
Map map_of_places() {
  Map map;
  for (KeyframeId id = 0; id < 6; ++id) {
    const bool first = id == 0 || id == 4;
    map.add_keyframe(empty_frame(40), Eigen::Isometry3d::Identity(), first ? kNoKeyframe : id - 1);
    for (std::uint32_t i = 0; i < 20 && !first; ++i) {
      map.add_observation(map.add_landmark({0, 0, 2}, {id - 1, 20 + i}), {id, i});
    }
  }
  return map;
}

std::vector<KeyframeId> keyframes(const std::vector<PlaceCandidate>& places) {
  std::vector<KeyframeId> ids;
  for (const PlaceCandidate& place : places) ids.push_back(place.keyframe);
  return ids;
}

TEST(Places, neighbours_that_agree_beat_a_lone_keyframe) {
  const Map map = map_of_places();
  KeyframeDatabase database;
  database.add(0, bag_of({1, 2, 3, 50}));
  database.add(1, bag_of({1, 2, 3, 4}));
  database.add(2, bag_of({1, 2, 3, 51}));
  database.add(4, bag_of({1, 2, 3, 4}));  // as alike as 1, but alone
  database.add(3, bag_of({90}));
  const auto places = find_places(database, map, bag_of({1, 2, 3, 4}));
  ASSERT_THAT(keyframes(places), ElementsAre(1));
  EXPECT_FLOAT_EQ(places[0].group_score, 1.0F + 0.75F + 0.75F);
  EXPECT_THAT(places[0].group, ElementsAre(1, 0, 2));
  PlaceQuery lenient;
  lenient.min_group_ratio = 0.1F;
  const auto more = find_places(database, map, bag_of({1, 2, 3, 4}), lenient);
  ASSERT_THAT(keyframes(more), ElementsAre(1, 4));
  EXPECT_EQ(more[0].map, 0U);
  EXPECT_EQ(more[1].map, 1U);
}

TEST(Places, respects_a_minimum_score_and_a_maximum_number) {
  const Map map = map_of_places();
  KeyframeDatabase database;
  for (const KeyframeId id : {0U, 2U, 4U}) database.add(id, bag_of({1, 2, 3, 100 + id}));
  PlaceQuery query;
  query.min_score = 0.8F;
  EXPECT_THAT(find_places(database, map, bag_of({1, 2, 3, 4}), query), IsEmpty());
  query.min_score = 0.7F;
  EXPECT_THAT(keyframes(find_places(database, map, bag_of({1, 2, 3, 4}), query)), ElementsAre(0, 2, 4));
  query.max_candidates = 2;
  EXPECT_THAT(keyframes(find_places(database, map, bag_of({1, 2, 3, 4}), query)), ElementsAre(0, 2));
}

}  // namespace
}  // namespace rtd::slam
