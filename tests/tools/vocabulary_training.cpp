// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/vocabulary_training.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/vision/features.hpp"

namespace rtd::slam {
namespace {

using Members = std::vector<const msg::Descriptor*>;
constexpr std::size_t kBits = 8 * sizeof(msg::Descriptor);

/// The bit that most members have, for every bit.
class Majority {
 public:
  void add(const msg::Descriptor& descriptor) {
    ++members_;
    for (std::size_t bit = 0; bit < kBits; ++bit) ones_[bit] += (descriptor[bit / 8] >> (bit % 8)) & 1U;
  }
  msg::Descriptor centre() const {
    msg::Descriptor centre{};
    for (std::size_t bit = 0; bit < kBits; ++bit) {
      if (2 * ones_[bit] > members_) centre[bit / 8] |= static_cast<std::uint8_t>(1U << (bit % 8));
    }
    return centre;
  }

 private:
  std::array<std::uint32_t, kBits> ones_{};
  std::uint32_t members_ = 0;
};

std::size_t nearest(const std::vector<msg::Descriptor>& centres, const msg::Descriptor& descriptor) {
  std::size_t best = 0;
  int best_distance = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const int distance = vision::hamming_distance(centres[i], descriptor);
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = i;
  }
  return best;
}

/// Starts that lie far apart: each drawn with a probability that grows with the squared distance to those before it.
std::vector<msg::Descriptor> choose_starts(const Members& members, std::size_t count, std::mt19937_64& random) {
  std::vector<msg::Descriptor> starts{*members[random() % members.size()]};
  std::vector<std::uint64_t> distance2(members.size(), std::numeric_limits<std::uint32_t>::max());
  while (starts.size() < count) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const auto d = static_cast<std::uint64_t>(vision::hamming_distance(*members[i], starts.back()));
      distance2[i] = std::min(distance2[i], d * d);
      sum += distance2[i];
    }
    if (sum == 0) break;  // fewer different descriptors than children
    std::uint64_t draw = random() % sum;
    std::size_t chosen = 0;
    while (draw >= distance2[chosen]) draw -= distance2[chosen++];
    starts.push_back(*members[chosen]);
  }
  return starts;
}

struct Cluster {
  msg::Descriptor centre;
  Members members;
};

std::vector<Cluster> assign(const Members& members, const std::vector<msg::Descriptor>& centres) {
  std::vector<Cluster> clusters;
  for (const msg::Descriptor& centre : centres) clusters.push_back({centre, {}});
  for (const msg::Descriptor* member : members) clusters[nearest(centres, *member)].members.push_back(member);
  std::erase_if(clusters, [](const Cluster& cluster) { return cluster.members.empty(); });
  return clusters;
}

/// k-majority: k-means with Hamming distance and majority instead of mean, Eq. (1).
std::vector<Cluster> split(const Members& members, const VocabularyTrainingOptions& options, std::mt19937_64& random) {
  auto centres = choose_starts(members, static_cast<std::size_t>(options.branching), random);
  std::vector<Cluster> clusters = assign(members, centres);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    std::vector<msg::Descriptor> moved;
    for (const Cluster& cluster : clusters) {
      Majority majority;
      for (const msg::Descriptor* member : cluster.members) majority.add(*member);
      moved.push_back(majority.centre());
    }
    if (moved == centres) break;
    centres = std::move(moved);
    clusters = assign(members, centres);
  }
  return clusters;
}

std::vector<VocabularyNode> grow_tree(Members all, const VocabularyTrainingOptions& options) {
  struct Growing {
    Members members;
    int level;
  };
  std::mt19937_64 random(options.seed);
  std::vector<VocabularyNode> nodes(1);
  std::vector<Growing> growing{{std::move(all), 0}};
  for (std::size_t i = 0; i < nodes.size(); ++i) {  // breadth first: nodes grow while we walk
    const Growing node = std::exchange(growing[i], {});
    if (node.level == options.depth || node.members.size() < 2) continue;
    std::vector<Cluster> clusters = split(node.members, options, random);
    if (clusters.size() < 2 && node.level > 0) continue;
    nodes[i].children = static_cast<std::uint8_t>(clusters.size());
    for (Cluster& cluster : clusters) {
      nodes.push_back({cluster.centre});
      growing.push_back({std::move(cluster.members), node.level + 1});
    }
  }
  return nodes;
}

}  // namespace

Vocabulary train_vocabulary(const std::vector<std::vector<msg::Descriptor>>& images,
                            const VocabularyTrainingOptions& options) {
  Members all;
  for (const auto& image : images) {
    for (const msg::Descriptor& descriptor : image) all.push_back(&descriptor);
  }
  if (all.size() < 2) throw std::invalid_argument("train_vocabulary: fewer than two descriptors");
  std::vector<VocabularyNode> nodes = grow_tree(std::move(all), options);
  const auto words = static_cast<std::size_t>(std::ranges::count(nodes, 0, &VocabularyNode::children));
  const Vocabulary unweighted(nodes, std::vector<float>(words, 1.0F));
  std::vector<std::uint32_t> images_with(words, 0);
  for (const auto& image : images) {
    std::set<WordId> seen;
    for (const msg::Descriptor& descriptor : image) seen.insert(unweighted.look_up(descriptor).word);
    for (const WordId word : seen) ++images_with[word];
  }
  std::vector<float> idf;
  for (const std::uint32_t count : images_with) {
    idf.push_back(std::log(static_cast<float>(1 + images.size()) / static_cast<float>(1 + count)));  // Eq. (2)
  }
  return {std::move(nodes), std::move(idf)};
}

}  // namespace rtd::slam
