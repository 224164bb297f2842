// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/topic_listener.hpp"

#include <utility>

namespace rtd::bus {

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
