// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/slam/core/place/vocabulary.hpp"

namespace rtd::slam {

struct VocabularyTrainingOptions {
  int branching = 8;   ///< children of a node, at most
  int depth = 5;       ///< levels below the root: at most branching^depth words
  int iterations = 6;  ///< of one clustering
  std::uint64_t seed = 1;
};

/// Builds the tree by hierarchical k-majority clustering and weighs the words by how few images show them:
/// docs/theory/place_recognition.md Eq. (1), (2). Same input, same tree. Throws std::invalid_argument without
/// descriptors.
Vocabulary train_vocabulary(const std::vector<std::vector<msg::Descriptor>>& images,
                            const VocabularyTrainingOptions& options);

}  // namespace rtd::slam
