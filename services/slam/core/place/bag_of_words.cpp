// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/place/bag_of_words.hpp"

#include <algorithm>

namespace rtd::slam {

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

}  // namespace rtd::slam
