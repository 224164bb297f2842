// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

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

}  // namespace rtd::slam
