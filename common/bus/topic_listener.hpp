// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus {

/// Reads all writers of one topic, whatever they offer: the reader requests what each of them has, reliable samples and
/// earlier ones only while all have them. For a new writer that offers less the reader is opened again. Thread-safe.
class TopicListener {
 public:
  /// `bus` outlives this. `in_place`, `depth`: as RawReaderOptions.
  TopicListener(RawBus& bus, RawHandlers handlers, bool in_place, int depth);

  /// One more writer of the topic. Throws BusError: refused, or of another type than the first one.
  void add(const TopicWriter& writer);
  bool reliable() const;
  bool latched() const;

 private:
  RawBus& bus_;
  const RawHandlers handlers_;
  mutable std::mutex mutex_;
  RawReaderOptions options_;
  std::unique_ptr<RawReader> reader_;
};

}  // namespace rtd::bus
