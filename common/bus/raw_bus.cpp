// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/raw_bus.hpp"

#include <algorithm>

namespace rtd::bus {

std::optional<RawLoss> SequenceGaps::next(const WriterId& writer, std::int64_t sequence) {
  const auto [known, is_first] = newest_.try_emplace(writer, sequence);
  const std::int64_t expected = is_first ? sequence : known->second + 1;
  known->second = std::max(known->second, sequence);
  if (sequence <= expected) return std::nullopt;
  return RawLoss{writer, expected, static_cast<std::uint64_t>(sequence - expected)};
}

ErasedCallback raw_callback(RawHandlers handlers) {
  return [handlers = std::move(handlers), gaps = SequenceGaps()](const std::shared_ptr<const void>& message,
                                                                 const WriterId&) mutable {
    const auto& sample = *std::static_pointer_cast<const RawSample>(message);
    const auto loss = gaps.next(sample.writer, sample.sequence);
    if (loss && handlers.on_lost) handlers.on_lost(*loss);
    if (sample.bytes && handlers.on_sample) handlers.on_sample(sample);
  };
}

}  // namespace rtd::bus
