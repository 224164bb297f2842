// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/writer_registry.hpp"

namespace rtd::bus {

std::vector<TopicWriter> WriterRegistry::writers() const {
  const std::lock_guard lock(mutex_);
  std::vector<TopicWriter> all;
  for (const auto& [id, writer] : writers_) all.push_back(writer);
  return all;
}

void WriterRegistry::watch(RawBus::Watcher watcher) {
  {
    const std::lock_guard lock(mutex_);
    watcher_ = nullptr;  // nothing more is posted
  }
  thread_.reset();  // waits for a running call
  if (!watcher) return;
  const std::lock_guard lock(mutex_);
  watcher_ = std::move(watcher);
  thread_.emplace();
  for (const auto& [id, writer] : writers_) tell(writer, WriterChange::kAppeared);
}

void WriterRegistry::note(const TopicWriter& writer) {
  const std::lock_guard lock(mutex_);
  const auto [known, is_new] = writers_.try_emplace(writer.id, writer);
  if (is_new) return tell(writer, WriterChange::kAppeared);
  if (known->second.qos == writer.qos && known->second.topic == writer.topic) return;
  known->second = writer;
  tell(writer, WriterChange::kChanged);
}

void WriterRegistry::note_gone(const WriterId& id) {
  const std::lock_guard lock(mutex_);
  if (const auto gone = writers_.extract(id); !gone.empty()) tell(gone.mapped(), WriterChange::kGone);
}

void WriterRegistry::tell(const TopicWriter& writer, WriterChange change) {
  if (watcher_) thread_->post([watcher = watcher_, writer, change] { watcher(writer, change); });
}

}  // namespace rtd::bus
