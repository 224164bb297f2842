// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/inprocess/domain.hpp"

#include <algorithm>

namespace rtd::bus::inprocess {
namespace {

bool same_topic(const Endpoint& a, const Endpoint& b) {
  return a.type == b.type && a.topic == b.topic;
}

bool connected(const WriterEndpoint& writer, const ReaderEndpoint& reader) {
  return same_topic(writer, reader) && incompatible_policy(writer.qos, reader.qos).empty();
}

void report_incompatible(Endpoint& endpoint, const std::string& policy) {
  if (!endpoint.callbacks.on_incompatible_qos) return;
  endpoint.thread->post([&callback = endpoint.callbacks.on_incompatible_qos, policy] { callback(policy); });
}

void change_matched(Endpoint& endpoint, int change) {
  const int peers = endpoint.matched += change;
  if (!endpoint.callbacks.on_matched) return;
  endpoint.thread->post([&callback = endpoint.callbacks.on_matched, peers] { callback(peers); });
}

void change_alive(ReaderEndpoint& reader) {
  if (!reader.callbacks.on_liveliness) return;
  const int alive = reader.matched;
  reader.thread->post([&callback = reader.callbacks.on_liveliness, alive] { callback(alive); });
}

/// Matches or refuses the pair; true when matched.
bool meet(WriterEndpoint& writer, ReaderEndpoint& reader) {
  if (!same_topic(writer, reader)) return false;
  const std::string policy = incompatible_policy(writer.qos, reader.qos);
  if (!policy.empty()) {
    report_incompatible(writer, policy);
    report_incompatible(reader, policy);
    return false;
  }
  change_matched(writer, 1);
  change_matched(reader, 1);
  change_alive(reader);
  return true;
}

}  // namespace

std::shared_ptr<Domain> Domain::join(std::uint32_t number) {
  static std::mutex mutex;
  static std::map<std::uint32_t, std::weak_ptr<Domain>> domains;
  const std::lock_guard lock(mutex);
  std::shared_ptr<Domain> domain = domains[number].lock();
  if (!domain) domains[number] = domain = std::make_shared<Domain>();
  return domain;
}

void Domain::add(WriterEndpoint& writer) {
  const std::lock_guard lock(mutex_);
  writers_.push_back(&writer);
  for (ReaderEndpoint* reader : readers_) meet(writer, *reader);
}

void Domain::add(ReaderEndpoint& reader) {
  const std::lock_guard lock(mutex_);
  readers_.push_back(&reader);
  for (WriterEndpoint* writer : writers_) {
    if (!meet(*writer, reader) || !reader.qos.transient_local) continue;
    for (const Message& message : writer->retained) deliver(reader, message);
  }
}

void Domain::remove(WriterEndpoint& writer) {
  const std::lock_guard lock(mutex_);
  writers_.erase(std::find(writers_.begin(), writers_.end(), &writer));
  for (ReaderEndpoint* reader : readers_) {
    if (!connected(writer, *reader)) continue;
    change_matched(*reader, -1);
    change_alive(*reader);
  }
}

void Domain::remove(ReaderEndpoint& reader) {
  const std::lock_guard lock(mutex_);
  readers_.erase(std::find(readers_.begin(), readers_.end(), &reader));
  for (WriterEndpoint* writer : writers_) {
    if (connected(*writer, reader)) change_matched(*writer, -1);
  }
}

void Domain::publish(WriterEndpoint& writer, const Message& message) {
  const std::lock_guard lock(mutex_);
  if (writer.qos.transient_local) {
    writer.retained.push_back(message);
    if (writer.retained.size() > static_cast<std::size_t>(writer.qos.depth)) writer.retained.pop_front();
  }
  for (ReaderEndpoint* reader : readers_) {
    if (connected(writer, *reader)) deliver(*reader, message);
  }
}

void Domain::deliver(ReaderEndpoint& reader, const Message& message) {
  if (reader.mailbox->deliver(message)) return;
  const int lost = ++reader.lost;
  if (!reader.callbacks.on_samples_lost) return;
  reader.thread->post([&callback = reader.callbacks.on_samples_lost, lost] { callback(lost); });
}

}  // namespace rtd::bus::inprocess
