// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/sequence_guard.hpp"

#include <algorithm>
#include <limits>

namespace rtd::bus {

bool SequenceGuard::plausible(const WriterGuid& writer, std::uint64_t number) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max() - kFar;
  if (number > kLargest) return false;
  if (known_.size() >= kWriters && !known_.contains(writer)) known_.clear();  // strangers must not fill the memory
  Known& known = known_[writer];
  if (number <= known.highest + kFar) {
    known.highest = std::max(known.highest, number);
    known.in_a_row = 0;
    return true;
  }
  const bool again = number <= known.doubtful + kFar && known.doubtful <= number + kFar;
  known.in_a_row = again ? known.in_a_row + 1 : 1;
  known.doubtful = number;
  if (known.in_a_row < kMessages) return false;
  known.highest = number;
  known.in_a_row = 0;
  return true;
}

}  // namespace rtd::bus
