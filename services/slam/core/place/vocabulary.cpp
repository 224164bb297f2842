// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/place/vocabulary.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/vision/features.hpp"

namespace rtd::slam {
namespace {

// File: magic, nodes (u32), words (u32), FNV-1a 64 of all that follows; then per node its centre and the number of its
// children (u8), per word its idf (float32). Little endian, nodes breadth first.
constexpr std::array<char, 8> kMagic = {'R', 'T', 'D', 'V', 'O', 'C', '0', '1'};
constexpr std::size_t kHeaderBytes = kMagic.size() + 2 * sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::size_t kNodeBytes = sizeof(msg::Descriptor) + 1;
constexpr const char* kFix = "; train it again with rtd-train-vocabulary or leave slam.place.vocabulary empty";

std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const std::byte byte : bytes) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001B3ULL;
  return hash;
}

template <typename T>
void append(std::vector<std::byte>& bytes, const T& value) {
  const auto* begin = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), begin, begin + sizeof(T));
}

template <typename T>
T take(std::span<const std::byte>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  bytes = bytes.subspan(sizeof(T));
  return value;
}

[[noreturn]] void refuse(const std::string& cause) {
  throw VocabularyError("vocabulary: " + cause + kFix);
}

}  // namespace

float similarity(const BagOfWords& a, const BagOfWords& b) {
  float sum = 0;
  for (auto i = a.words.begin(), j = b.words.begin(); i != a.words.end() && j != b.words.end();) {
    if (i->word == j->word) {
      sum += std::min((i++)->weight, (j++)->weight);
    } else {
      ++(i->word < j->word ? i : j);
    }
  }
  return sum;
}

Vocabulary::Vocabulary(std::vector<VocabularyNode> nodes, std::vector<float> idf)
    : nodes_(std::move(nodes)), idf_(std::move(idf)) {
  if (nodes_.size() < 2 || nodes_[0].children == 0) refuse("no words");
  std::size_t next = 1;
  WordId words = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (i >= next) refuse("node " + std::to_string(i) + " has no parent");
    nodes_[i].first_child = static_cast<std::uint32_t>(next);
    next += nodes_[i].children;
    if (nodes_[i].children == 0) nodes_[i].word = words++;
  }
  if (next != nodes_.size()) refuse("children that do not exist");
  if (words != idf_.size()) refuse(std::to_string(words) + " words, " + std::to_string(idf_.size()) + " weights");
  for (const float weight : idf_) {
    if (!std::isfinite(weight) || weight < 0) refuse("a weight that is negative or not finite");
  }
}

Vocabulary Vocabulary::parse(std::span<const std::byte> bytes) {
  if (bytes.size() > kMaxBytes) refuse(std::to_string(bytes.size()) + " bytes, at most 2 MB are read");
  if (bytes.size() < kHeaderBytes || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
    refuse("no vocabulary of this version (it begins with RTDVOC01)");
  }
  bytes = bytes.subspan(kMagic.size());
  const std::size_t node_count = take<std::uint32_t>(bytes), word_count = take<std::uint32_t>(bytes);
  const auto expected = take<std::uint64_t>(bytes);
  if (bytes.size() != node_count * kNodeBytes + word_count * sizeof(float)) {
    refuse("cut short or too long: " + std::to_string(bytes.size()) + " bytes for " + std::to_string(node_count) +
           " nodes");
  }
  if (checksum(bytes) != expected) refuse("damaged: its checksum does not match");
  std::vector<VocabularyNode> nodes(node_count);
  for (VocabularyNode& node : nodes) {
    node.centre = take<msg::Descriptor>(bytes);
    node.children = take<std::uint8_t>(bytes);
  }
  std::vector<float> idf(word_count);
  for (float& weight : idf) weight = take<float>(bytes);
  return {std::move(nodes), std::move(idf)};
}

std::vector<std::byte> Vocabulary::serialize() const {
  std::vector<std::byte> body;
  for (const VocabularyNode& node : nodes_) {
    append(body, node.centre);
    append(body, node.children);
  }
  for (const float weight : idf_) append(body, weight);
  std::vector<std::byte> bytes;
  for (const char letter : kMagic) append(bytes, letter);
  append(bytes, static_cast<std::uint32_t>(nodes_.size()));
  append(bytes, static_cast<std::uint32_t>(idf_.size()));
  append(bytes, checksum(body));
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

Vocabulary::Place Vocabulary::look_up(const msg::Descriptor& descriptor) const {
  Place place;
  std::uint32_t at = 0;
  for (int level = 1; nodes_[at].children != 0; ++level) {
    int nearest = std::numeric_limits<int>::max();
    const std::uint32_t first = nodes_[at].first_child, end = first + nodes_[at].children;
    for (std::uint32_t child = first; child < end; ++child) {
      const int distance = vision::hamming_distance(descriptor, nodes_[child].centre);
      if (distance >= nearest) continue;
      nearest = distance;
      at = child;
    }
    if (level <= kGroupLevel) place.group = static_cast<std::uint16_t>(at);
  }
  place.word = nodes_[at].word;
  return place;
}

BagOfWords Vocabulary::describe(std::span<const msg::Feature> features) const {
  BagOfWords bag;
  bag.groups.reserve(features.size());
  std::vector<WordId> seen;
  seen.reserve(features.size());
  for (const msg::Feature& feature : features) {
    const Place place = look_up(feature.descriptor);
    bag.groups.push_back(place.group);
    seen.push_back(place.word);
  }
  std::sort(seen.begin(), seen.end());
  double sum = 0;
  for (const WordId word : seen) {
    if (bag.words.empty() || bag.words.back().word != word) bag.words.push_back({word, 0});
    bag.words.back().weight += idf_[word];
    sum += static_cast<double>(idf_[word]);
  }
  std::erase_if(bag.words, [](const WeightedWord& w) { return w.weight <= 0; });
  for (WeightedWord& word : bag.words) word.weight = static_cast<float>(static_cast<double>(word.weight) / sum);
  return bag;
}

}  // namespace rtd::slam
