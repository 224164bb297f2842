// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/inprocess/domain.hpp"

#include <cstring>
#include <map>
#include <tuple>
#include <utility>

namespace rtd::bus::inprocess {

std::string incompatible_policy(const QosSettings& offered, const QosSettings& requested) {
  if (requested.transient_local && !offered.transient_local) return "DURABILITY";
  const bool offers_lease = offered.liveliness_lease_ms > 0, asks_lease = requested.liveliness_lease_ms > 0;
  if (asks_lease && (!offers_lease || offered.liveliness_lease_ms > requested.liveliness_lease_ms)) return "LIVELINESS";
  const bool offers_deadline = offered.deadline_ms > 0, asks_deadline = requested.deadline_ms > 0;
  if (asks_deadline && (!offers_deadline || offered.deadline_ms > requested.deadline_ms)) return "DEADLINE";
  return {};
}

namespace {

bool same_topic(const EndpointKind& a, const EndpointKind& b) {
  return a.type == b.type && a.topic == b.topic;
}

std::string refused_policy(const EndpointKind& offered, const EndpointKind& requested) {
  if (requested.reliable && !offered.reliable) return "RELIABILITY";
  return incompatible_policy(offered.qos, requested.qos);
}

bool connected(const WriterEndpoint& writer, const ReaderEndpoint& reader) {
  return same_topic(writer.kind, reader.kind) && refused_policy(writer.kind, reader.kind).empty();
}

template <class Endpoint>
void change_matched(Endpoint& endpoint, int change) {
  endpoint.status.report_matched(endpoint.status.matched() + change);
}

/// Matches or refuses the pair; true when matched.
bool match(WriterEndpoint& writer, ReaderEndpoint& reader) {
  if (!same_topic(writer.kind, reader.kind)) return false;
  const std::string policy = refused_policy(writer.kind, reader.kind);
  if (!policy.empty()) {
    writer.status.report_incompatible_qos(policy);
    reader.status.report_incompatible_qos(policy);
    return false;
  }
  change_matched(writer, 1);
  change_matched(reader, 1);
  reader.status.report_liveliness(reader.status.matched());
  reader.status.report_writer(writer.id, true);
  return true;
}

void deliver(ReaderEndpoint& reader, const Message& message) {
  if (!reader.deliveries.deliver(message)) reader.status.report_lost(++reader.lost);
}

}  // namespace

bool DeliveryQueue::deliver(Message message) {
  bool kept_all = true;
  {
    const std::lock_guard lock(mutex_);
    if (messages_.size() >= depth_) {
      messages_.pop_front();
      kept_all = false;
    }
    messages_.push_back(std::move(message));
  }
  thread_.wake();
  return kept_all;
}

bool DeliveryQueue::handle_one() {
  std::unique_lock lock(mutex_);
  if (messages_.empty()) return false;
  Message message = std::move(messages_.front());
  messages_.pop_front();
  lock.unlock();
  on_message_(std::move(message));
  return true;
}

std::shared_ptr<Domain> Domain::join(std::uint32_t number, Content content) {
  static std::mutex mutex;
  static std::map<std::pair<std::uint32_t, Content>, std::weak_ptr<Domain>> domains;
  const std::lock_guard lock(mutex);
  std::weak_ptr<Domain>& known = domains[{number, content}];
  std::shared_ptr<Domain> domain = known.lock();
  if (!domain) known = domain = std::make_shared<Domain>();
  return domain;
}

WriterId Domain::new_id() {
  const std::lock_guard lock(mutex_);
  return next_id();
}

WriterId Domain::new_id(const WriterId& connection) {
  const std::lock_guard lock(mutex_);
  WriterId id = connection;
  ++ids_;
  std::memcpy(id.data() + std::tuple_size<ParticipantId>(), &ids_, sizeof(ids_));
  return id;
}

WriterId Domain::next_id() {
  WriterId id{};
  ++ids_;
  std::memcpy(id.data(), &ids_, sizeof(ids_));
  return id;
}

void Domain::add(EndpointRegistry& registry) {
  const std::lock_guard lock(mutex_);
  registries_.push_back(&registry);
  for (const WriterEndpoint* writer : writers_)
    if (writer->discovered) registry.note(*writer->discovered);
}

void Domain::add(WriterEndpoint& writer) {
  const std::lock_guard lock(mutex_);
  writers_.push_back(&writer);
  if (writer.discovered)
    for (EndpointRegistry* registry : registries_) registry->note(*writer.discovered);
  for (ReaderEndpoint* reader : readers_) match(writer, *reader);
}

void Domain::add(ReaderEndpoint& reader) {
  const std::lock_guard lock(mutex_);
  readers_.push_back(&reader);
  reader.id = next_id();
  for (WriterEndpoint* writer : writers_) {
    if (!match(*writer, reader) || !reader.kind.qos.transient_local) continue;
    for (const Message& message : writer->retained) deliver(reader, message);
  }
}

void Domain::remove(EndpointRegistry& registry) {
  const std::lock_guard lock(mutex_);
  std::erase(registries_, &registry);
}

void Domain::remove(WriterEndpoint& writer) {
  const std::lock_guard lock(mutex_);
  std::erase(writers_, &writer);
  if (writer.discovered)
    for (EndpointRegistry* registry : registries_) registry->note_gone(writer.discovered->id);
  for (ReaderEndpoint* reader : readers_) {
    if (!connected(writer, *reader)) continue;
    change_matched(*reader, -1);
    reader->status.report_liveliness(reader->status.matched());
    reader->status.report_writer(writer.id, false);
  }
}

void Domain::remove(ReaderEndpoint& reader) {
  const std::lock_guard lock(mutex_);
  std::erase(readers_, &reader);
  for (WriterEndpoint* writer : writers_) {
    if (connected(*writer, reader)) change_matched(*writer, -1);
  }
}

std::vector<TopicReader> Domain::readers() const {
  const std::lock_guard lock(mutex_);
  std::vector<TopicReader> all;
  for (const ReaderEndpoint* reader : readers_) all.push_back({reader->id, {reader->kind.topic, reader->kind.type}});
  return all;
}

void Domain::publish(WriterEndpoint& writer, std::shared_ptr<const void> content) {
  const Message message{std::move(content), writer.id};
  const std::lock_guard lock(mutex_);
  if (writer.kind.qos.transient_local) {
    writer.retained.push_back(message);
    if (writer.retained.size() > static_cast<std::size_t>(writer.kind.qos.depth)) writer.retained.pop_front();
  }
  for (ReaderEndpoint* reader : readers_) {
    if (connected(writer, *reader)) deliver(*reader, message);
  }
}

}  // namespace rtd::bus::inprocess
