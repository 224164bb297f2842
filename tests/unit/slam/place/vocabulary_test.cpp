// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/place/vocabulary.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <random>
#include <set>

#include "common/vision/features.hpp"
#include "tests/support/time_bounds.hpp"
#include "tests/tools/vocabulary_training.hpp"

namespace rtd::slam {
namespace {

using ::testing::HasSubstr;

msg::Descriptor random_descriptor(std::mt19937_64& random) {
  msg::Descriptor descriptor;
  for (std::uint8_t& byte : descriptor) byte = static_cast<std::uint8_t>(random());
  return descriptor;
}

msg::Descriptor with_flipped_bits(msg::Descriptor descriptor, int bits, std::mt19937_64& random) {
  for (int i = 0; i < bits; ++i) {
    const std::uint64_t bit = random() % 256;
    descriptor[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
  }
  return descriptor;
}

/// Images of 100 features each, drawn from 64 kinds with 8 bits of noise.
struct Prototypes {
  std::vector<msg::Descriptor> kinds;
  std::vector<std::vector<msg::Descriptor>> images;

  Prototypes() {
    std::mt19937_64 random(5);
    for (int i = 0; i < 64; ++i) kinds.push_back(random_descriptor(random));
    for (int image = 0; image < 20; ++image) {
      images.emplace_back();
      for (int i = 0; i < 100; ++i) {
        images.back().push_back(with_flipped_bits(kinds[random() % kinds.size()], 8, random));
      }
    }
  }
};

std::vector<msg::Feature> features_of(const std::vector<msg::Descriptor>& descriptors) {
  std::vector<msg::Feature> features(descriptors.size());
  for (std::size_t i = 0; i < features.size(); ++i) features[i].descriptor = descriptors[i];
  return features;
}

TEST(VocabularyTraining, gives_noisy_views_of_one_patch_one_word) {
  const Prototypes prototypes;
  const Vocabulary vocabulary = train_vocabulary(prototypes.images, {8, 2, 6, 1});
  std::mt19937_64 random(6);
  std::set<WordId> words;
  int same = 0;
  for (const msg::Descriptor& kind : prototypes.kinds) {
    const WordId word = vocabulary.look_up(kind).word;
    words.insert(word);
    for (int i = 0; i < 10; ++i) same += vocabulary.look_up(with_flipped_bits(kind, 8, random)).word == word ? 1 : 0;
  }
  EXPECT_GT(words.size(), 40U);  // of 64 leaves
  EXPECT_GT(same, 600);          // of 640
}

TEST(VocabularyTraining, centres_are_majorities) {
  std::mt19937_64 random(7);
  const msg::Descriptor a = random_descriptor(random), b = random_descriptor(random);
  std::vector<std::vector<msg::Descriptor>> images(1);
  for (int i = 0; i < 200; ++i) images[0].push_back(with_flipped_bits(i % 2 == 0 ? a : b, 20, random));
  const Vocabulary vocabulary = train_vocabulary(images, {2, 1, 10, 1});
  ASSERT_EQ(vocabulary.words(), 2U);
  for (const msg::Descriptor& truth : {a, b}) {
    const int error = std::min(vision::hamming_distance(vocabulary.nodes()[1].centre, truth),
                               vision::hamming_distance(vocabulary.nodes()[2].centre, truth));
    EXPECT_EQ(error, 0);
  }
}

TEST(VocabularyTraining, same_input_same_bytes) {
  const Prototypes prototypes;
  EXPECT_EQ(train_vocabulary(prototypes.images, {}).serialize(), train_vocabulary(prototypes.images, {}).serialize());
}

TEST(VocabularyTraining, copes_with_equal_descriptors_and_refuses_none) {
  const std::vector<std::vector<msg::Descriptor>> equal(3, std::vector<msg::Descriptor>(50));
  EXPECT_EQ(train_vocabulary(equal, {}).words(), 1U);
  EXPECT_THROW(train_vocabulary({}, {}), std::invalid_argument);
}

TEST(Vocabulary, finds_what_a_full_comparison_at_each_level_finds) {
  const auto vocabulary = built_in_vocabulary();
  std::mt19937_64 random(8);
  const auto& nodes = vocabulary->nodes();
  for (int i = 0; i < 100; ++i) {
    const msg::Descriptor descriptor = random_descriptor(random);
    std::uint32_t at = 0;
    while (nodes[at].children != 0) {
      std::uint32_t best = nodes[at].first_child;
      for (std::uint32_t c = best; c < nodes[at].first_child + nodes[at].children; ++c) {
        if (vision::hamming_distance(nodes[c].centre, descriptor) <
            vision::hamming_distance(nodes[best].centre, descriptor)) {
          best = c;
        }
      }
      at = best;
    }
    EXPECT_EQ(vocabulary->look_up(descriptor).word, nodes[at].word);
  }
}

TEST(Vocabulary, rare_words_weigh_more_and_weights_add_up_to_one) {
  std::mt19937_64 random(9);
  const msg::Descriptor common = random_descriptor(random), rare = random_descriptor(random);
  const Vocabulary vocabulary = train_vocabulary({{common}, {common}, {common}, {common, rare}}, {2, 1, 5, 1});
  const BagOfWords bag = vocabulary.describe(features_of({common, rare}));
  ASSERT_EQ(bag.words.size(), 1U);  // what every image shows carries no information: idf 0
  EXPECT_EQ(bag.words[0].word, vocabulary.look_up(rare).word);
  EXPECT_FLOAT_EQ(bag.words[0].weight, 1.0F);
  EXPECT_EQ(bag.groups.size(), 2U);
  EXPECT_TRUE(vocabulary.describe({}).words.empty());
}

TEST(Vocabulary, two_views_share_more_than_two_places) {
  const Prototypes prototypes;
  const Vocabulary vocabulary = train_vocabulary(prototypes.images, {8, 3, 6, 1});
  std::mt19937_64 random(10);
  std::vector<msg::Descriptor> place, again, other;
  for (int i = 0; i < 30; ++i) {
    const msg::Descriptor& kind = prototypes.kinds[static_cast<std::size_t>(i)];
    place.push_back(with_flipped_bits(kind, 8, random));
    again.push_back(with_flipped_bits(kind, 8, random));
    other.push_back(prototypes.kinds[static_cast<std::size_t>(i + 30)]);
  }
  const auto bag = [&](const auto& descriptors) { return vocabulary.describe(features_of(descriptors)); };
  EXPECT_FLOAT_EQ(similarity(bag(place), bag(place)), 1.0F);
  EXPECT_GT(similarity(bag(place), bag(again)), 4 * similarity(bag(place), bag(other)));
  EXPECT_EQ(similarity(bag(place), BagOfWords{}), 0.0F);
}

TEST(Vocabulary, reads_what_it_wrote) {
  const auto vocabulary = built_in_vocabulary();
  const auto bytes = vocabulary->serialize();
  EXPECT_LE(bytes.size(), Vocabulary::kMaxBytes);
  EXPECT_EQ(Vocabulary::parse(bytes).serialize(), bytes);
}

TEST(Vocabulary, is_there_at_once) {
  const auto bytes = built_in_vocabulary()->serialize();
  const auto start = std::chrono::steady_clock::now();
  const Vocabulary vocabulary = Vocabulary::parse(bytes);
  const std::chrono::milliseconds limit(test_support::checks_time() ? 200 : 2000);
  EXPECT_LT(std::chrono::steady_clock::now() - start, limit);
  EXPECT_GT(vocabulary.words(), 10'000U);
}

std::string refusal(std::span<const std::byte> bytes) {
  try {
    Vocabulary::parse(bytes);
  } catch (const VocabularyError& error) {
    return error.what();
  }
  return "";
}

TEST(Vocabulary, refuses_a_damaged_file_with_the_reason) {
  const Prototypes prototypes;
  const auto bytes = train_vocabulary(prototypes.images, {4, 2, 3, 1}).serialize();
  ASSERT_EQ(refusal(bytes), "");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THAT(refusal({bytes.data(), size}), HasSubstr("vocabulary: ")) << size;
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += 3) {
    auto damaged = bytes;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    EXPECT_NE(refusal(damaged), "") << bit;
  }
  EXPECT_THAT(refusal({bytes.data(), bytes.size() - 1}), HasSubstr("cut short"));
  auto damaged = bytes;
  damaged.back() ^= std::byte{1};
  EXPECT_THAT(refusal(damaged), HasSubstr("checksum"));
  EXPECT_THAT(refusal(std::vector<std::byte>(100)), HasSubstr("no vocabulary of this version"));
  EXPECT_THAT(refusal(std::vector<std::byte>(3'000'000)), HasSubstr("2 MB"));
}

TEST(Vocabulary, refuses_nodes_that_are_no_tree) {
  EXPECT_THROW(Vocabulary({}, {}), VocabularyError);
  EXPECT_THROW(Vocabulary(std::vector<VocabularyNode>(2), {1.0F}), VocabularyError);  // the second has no parent
  std::vector<VocabularyNode> nodes(3);
  nodes[0].children = 5;
  EXPECT_THROW(Vocabulary(nodes, {1.0F, 1.0F}), VocabularyError);
  nodes[0].children = 2;
  EXPECT_THROW(Vocabulary(nodes, {1.0F}), VocabularyError);
  EXPECT_THROW(Vocabulary(nodes, {1.0F, -1.0F}), VocabularyError);
  EXPECT_NO_THROW(Vocabulary(nodes, {1.0F, 1.0F}));
}

}  // namespace
}  // namespace rtd::slam
