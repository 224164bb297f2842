// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/rtps_screen.hpp"

#include <algorithm>
#include <limits>

namespace rtd::bus {

bool SequenceGuard::plausible(const WriterGuid& writer, std::uint64_t number) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max() - kFar;
  if (number > kLargest) return false;
  if (known_.size() >= kWriters && !known_.contains(writer))
    known_.clear();  // unknown participants must not fill the memory
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

bool RtpsScreen::passes(std::span<const std::byte> datagram) {
  const RtpsMessage message = read_rtps_message(datagram);
  if (!message.well_formed || !message.whole_fragments) return false;
  return std::all_of(message.numbers.begin(), message.numbers.end(),
                     [this](const WriterNumber& named) { return guard_.plausible(named.writer, named.number); });
}

}  // namespace rtd::bus
