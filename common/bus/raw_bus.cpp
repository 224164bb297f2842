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

TopicListener::TopicListener(RawBus& bus, RawHandlers handlers, bool in_place, int depth)
    : bus_(bus), handlers_(std::move(handlers)) {
  options_.reliable = true;
  options_.transient_local = true;
  options_.depth = depth;
  options_.in_place = in_place;
}

void TopicListener::add(const TopicWriter& writer) {
  const std::lock_guard lock(mutex_);
  RawReaderOptions options = options_;
  options.reliable = options.reliable && writer.qos.reliable;
  options.transient_local = options.transient_local && writer.qos.durability != RawQos::Durability::kVolatile;
  options.in_place = options.in_place && writer.shared_memory;
  const bool serves = options.reliable == options_.reliable && options.transient_local == options_.transient_local &&
                      options.in_place == options_.in_place;
  if (reader_ != nullptr && serves) return;
  options_ = options;
  reader_.reset();
  reader_ = bus_.reader(writer.topic, options_, handlers_);
}

bool TopicListener::reliable() const {
  const std::lock_guard lock(mutex_);
  return options_.reliable;
}

bool TopicListener::latched() const {
  const std::lock_guard lock(mutex_);
  return options_.transient_local;
}

}  // namespace rtd::bus
