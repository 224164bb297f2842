// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/msg/features.hpp"

namespace rtd::slam {

using WordId = std::uint32_t;

struct WeightedWord {
  WordId word = 0;
  float weight = 0;
};

/// What an image shows, as words of a Vocabulary.
struct BagOfWords {
  std::vector<WeightedWord> words;    ///< ascending, weights add up to 1; empty without features
  std::vector<std::uint16_t> groups;  ///< per feature: an inner node of the tree; like features share one
};

/// Likeness of two images in [0, 1]: what their weights have in common. docs/theory/place_recognition.md Eq. (3).
float similarity(const BagOfWords& a, const BagOfWords& b);

/// A vocabulary file that cannot be used; the message names cause and fix.
class VocabularyError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One node of the tree. Children are consecutive; a node without children is a word.
struct VocabularyNode {
  msg::Descriptor centre{};  ///< the root's is not used
  std::uint32_t first_child = 0;
  std::uint8_t children = 0;
  WordId word = 0;  ///< of a leaf
};

/// A tree of binary cluster centres that turns 256-bit descriptors into words: at each level the nearest child (Hamming
/// distance) is taken. docs/theory/place_recognition.md. Immutable: any thread.
class Vocabulary {
 public:
  /// Levels below the root at which descriptors are grouped for matching: BagOfWords::groups.
  static constexpr int kGroupLevel = 2;
  static constexpr std::size_t kMaxBytes = 2'000'000;

  /// `nodes` breadth first, `idf` per word in the order of the leaves. Throws VocabularyError when they are no tree.
  Vocabulary(std::vector<VocabularyNode> nodes, std::vector<float> idf);

  /// Reads what serialize() made. Throws VocabularyError for anything else, saying why.
  static Vocabulary parse(std::span<const std::byte> bytes);
  std::vector<std::byte> serialize() const;

  /// Word of one descriptor and the group that it belongs to.
  struct Place {
    WordId word = 0;
    std::uint16_t group = 0;
  };
  Place look_up(const msg::Descriptor& descriptor) const;
  /// The words of an image, weighted by tf-idf and normalised: Eq. (2). Groups per feature.
  BagOfWords describe(std::span<const msg::Feature> features) const;

  std::size_t words() const { return idf_.size(); }
  const std::vector<VocabularyNode>& nodes() const { return nodes_; }
  const std::vector<float>& idf() const { return idf_; }

 private:
  std::vector<VocabularyNode> nodes_;
  std::vector<float> idf_;
};

/// The vocabulary that was trained when this program was built (rtd-train-vocabulary) and lies inside it. Read at the
/// first call, then shared. Any thread.
std::shared_ptr<const Vocabulary> built_in_vocabulary();

}  // namespace rtd::slam
