// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "common/bus/callback_thread.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus {

/// The writers of a domain, as a vendor's discovery tells of them. Its threads only take notes; the watcher has a
/// thread of its own, so that it may create readers. Thread-safe.
class WriterRegistry {
 public:
  std::vector<TopicWriter> writers() const;
  void watch(RawBus::Watcher watcher);

  void note(const TopicWriter& writer);
  void note_gone(const WriterId& id);

 private:
  void tell(const TopicWriter& writer, WriterChange change);

  mutable std::mutex mutex_;
  std::map<WriterId, TopicWriter> writers_;
  RawBus::Watcher watcher_;
  std::optional<CallbackThread> thread_;
};

}  // namespace rtd::bus
