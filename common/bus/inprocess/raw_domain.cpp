// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/inprocess/raw_domain.hpp"

#include <cstring>

namespace rtd::bus::inprocess {
namespace {

bool keeps_history(const RawWriterEndpoint& writer) {
  return writer.writer.qos.durability != RawQos::Durability::kVolatile;
}

bool connected(const RawWriterEndpoint& writer, const RawReaderEndpoint& reader) {
  const bool same = writer.writer.topic.name == reader.topic.name && writer.writer.topic.type == reader.topic.type;
  const bool reliable = writer.writer.qos.reliable || !reader.options.reliable;
  const bool durable = keeps_history(writer) || !reader.options.transient_local;
  return same && reliable && durable;
}

}  // namespace

std::shared_ptr<RawDomain> RawDomain::join(std::uint32_t number) {
  static std::mutex mutex;
  static std::map<std::uint32_t, std::weak_ptr<RawDomain>> domains;
  const std::lock_guard lock(mutex);
  std::shared_ptr<RawDomain> domain = domains[number].lock();
  if (!domain) domains[number] = domain = std::make_shared<RawDomain>();
  return domain;
}

WriterId RawDomain::new_id() {
  const std::lock_guard lock(mutex_);
  WriterId id{};
  ++ids_;
  std::memcpy(id.data(), &ids_, sizeof(ids_));
  return id;
}

std::vector<TopicWriter> RawDomain::writers() const {
  const std::lock_guard lock(mutex_);
  std::vector<TopicWriter> all;
  for (const RawWriterEndpoint* writer : writers_) all.push_back(writer->writer);
  return all;
}

void RawDomain::tell(const TopicWriter& writer, WriterChange change) {
  for (RawWatcher* watcher : watchers_) {
    watcher->thread->post([call = watcher->call, writer, change] { call(writer, change); });
  }
}

void RawDomain::add(RawWriterEndpoint& writer) {
  const std::lock_guard lock(mutex_);
  writers_.push_back(&writer);
  tell(writer.writer, WriterChange::kAppeared);
  for (RawReaderEndpoint* reader : readers_) {
    if (!connected(writer, *reader)) continue;
    ++writer.matched;
    ++reader->matched;
  }
}

void RawDomain::add(RawReaderEndpoint& reader) {
  const std::lock_guard lock(mutex_);
  readers_.push_back(&reader);
  for (RawWriterEndpoint* writer : writers_) {
    if (!connected(*writer, reader)) continue;
    ++writer->matched;
    ++reader.matched;
    if (!reader.options.transient_local) continue;
    for (const auto& sample : writer->retained) reader.mailbox->deliver(sample);
  }
}

void RawDomain::add(RawWatcher& watcher) {
  const std::lock_guard lock(mutex_);
  watchers_.push_back(&watcher);
  for (const RawWriterEndpoint* known : writers_) {
    watcher.thread->post([call = watcher.call, writer = known->writer] { call(writer, WriterChange::kAppeared); });
  }
}

void RawDomain::remove(RawWriterEndpoint& writer) {
  const std::lock_guard lock(mutex_);
  std::erase(writers_, &writer);
  tell(writer.writer, WriterChange::kGone);
  for (RawReaderEndpoint* reader : readers_) {
    if (connected(writer, *reader)) --reader->matched;
  }
}

void RawDomain::remove(RawReaderEndpoint& reader) {
  const std::lock_guard lock(mutex_);
  std::erase(readers_, &reader);
  for (RawWriterEndpoint* writer : writers_) {
    if (connected(*writer, reader)) --writer->matched;
  }
}

void RawDomain::remove(RawWatcher& watcher) {
  const std::lock_guard lock(mutex_);
  std::erase(watchers_, &watcher);
}

void RawDomain::publish(RawWriterEndpoint& writer, RawSample sample) {
  const std::lock_guard lock(mutex_);
  sample.writer = writer.writer.id;
  sample.sequence = ++writer.sequence;
  const auto shared = std::make_shared<const RawSample>(std::move(sample));
  if (keeps_history(writer)) {
    writer.retained.push_back(shared);
    if (writer.retained.size() > static_cast<std::size_t>(writer.writer.qos.depth)) writer.retained.pop_front();
  }
  for (RawReaderEndpoint* reader : readers_) {
    if (connected(writer, *reader)) reader->mailbox->deliver(shared);
  }
}

}  // namespace rtd::bus::inprocess
