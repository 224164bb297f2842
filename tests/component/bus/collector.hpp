// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "common/bus/raw_bus.hpp"
#include "common/concurrency/bounded_queue.hpp"

namespace rtd::bus {

/// Takes what a reader gets and hands it to the test in order.
template <class T>
class Collector {
 public:
  std::function<void(std::shared_ptr<const T>)> callback() {
    return [this](std::shared_ptr<const T> message) { push(std::move(message)); };
  }
  void push(std::shared_ptr<const T> message) { queue_.push(std::move(message)); }
  /// The next message; throws when none came within the time, so that a test fails instead of hanging.
  std::shared_ptr<const T> next(std::chrono::milliseconds timeout = std::chrono::seconds(5)) {
    auto message = queue_.pop_for(timeout);
    if (!message) throw std::runtime_error("no message arrived");
    return *message;
  }
  /// The next message or null.
  std::shared_ptr<const T> try_next(std::chrono::milliseconds timeout) {
    return queue_.pop_for(timeout).value_or(nullptr);
  }
  std::size_t size() const { return queue_.size(); }

 private:
  concurrency::BoundedQueue<std::shared_ptr<const T>> queue_{100'000, concurrency::Overflow::kDropOldest};
};

/// Of a reader of bytes.
inline RawHandlers into(Collector<RawSample>& samples) {
  RawHandlers handlers;
  handlers.on_sample = [&samples](RawSample sample) {
    samples.push(std::make_shared<const RawSample>(std::move(sample)));
  };
  return handlers;
}

/// The writer of another process, or connection, once it is known.
inline TopicWriter discovered_writer(const RawBus& bus, const std::string& topic) {
  for (int i = 0; i < 10'000; ++i) {
    for (const TopicWriter& writer : bus.writers()) {
      if (writer.topic.name == topic && !writer.own) return writer;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  throw std::runtime_error("no writer of " + topic);
}

}  // namespace rtd::bus
