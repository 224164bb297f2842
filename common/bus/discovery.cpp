// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/discovery.hpp"

#include <algorithm>

#include "common/bus/robot.hpp"
#include "common/io/printable.hpp"

namespace rtd::bus {
namespace {

/// Names of topics and types stand in logs and on terminals. DDS allows no others than visible ASCII; an endpoint with
/// another one takes part in nothing.
bool is_wire_name(const std::string& name) {
  constexpr std::size_t kLongest = 512;
  return !name.empty() && name.size() <= kLongest &&
         std::ranges::all_of(name, [](char c) { return c > ' ' && c <= '~' && c != '"' && c != '\\'; });
}

}  // namespace

TopicTypes::Watch::Watch(TopicTypes& types, const std::string& topic, const std::string& type, StatusReporter& status)
    : types_(types), topic_(topic), type_(type), status_(status) {
  const std::lock_guard lock(types_.mutex_);
  types_.watches_.push_back(this);
  for (const auto& [id, endpoint] : types_.endpoints_) {
    if (endpoint.topic == topic_) compare(endpoint.type);
  }
}

TopicTypes::Watch::~Watch() {
  const std::lock_guard lock(types_.mutex_);
  types_.watches_.remove(this);
}

void TopicTypes::Watch::compare(const std::string& other_type) const {
  if (other_type != type_) status_.report_type_mismatch(other_type);
}

void TopicTypes::appeared(const std::string& endpoint, const std::string& topic, const std::string& type) {
  if (!is_wire_name(type)) return;
  const std::lock_guard lock(mutex_);
  if (!endpoints_.try_emplace(endpoint, Endpoint{topic, type}).second) return;  // its QoS changed
  for (const Watch* watch : watches_) {
    if (watch->topic_ == topic) watch->compare(type);
  }
}

void TopicTypes::gone(const std::string& endpoint) {
  const std::lock_guard lock(mutex_);
  endpoints_.erase(endpoint);
}

std::vector<TopicWriter> EndpointRegistry::writers() const {
  const std::lock_guard lock(mutex_);
  std::vector<TopicWriter> all;
  for (const auto& [id, writer] : writers_) all.push_back(writer);
  return all;
}

std::vector<TopicReader> EndpointRegistry::readers() const {
  const std::lock_guard lock(mutex_);
  std::vector<TopicReader> all;
  for (const auto& [id, reader] : readers_) all.push_back(reader);
  return all;
}

std::map<ParticipantId, std::string> EndpointRegistry::participants() const {
  const std::lock_guard lock(mutex_);
  return participants_;
}

void EndpointRegistry::watch(RawBus::Watcher watcher) {
  {
    const std::lock_guard lock(mutex_);
    watcher_ = nullptr;  // nothing more is posted
  }
  thread_.reset();  // waits for a running call
  if (!watcher) return;
  const std::lock_guard lock(mutex_);
  watcher_ = std::move(watcher);
  thread_.emplace();
  for (const auto& [id, writer] : writers_) report(writer, WriterChange::kAppeared);
}

void EndpointRegistry::note(const TopicWriter& writer) {
  if (!is_wire_name(writer.topic.name) || !is_wire_name(writer.topic.type)) return;
  if (writer.own && writer.topic.name == kRosGraphTopic) return;  // that the connection itself is a node
  const std::lock_guard lock(mutex_);
  const auto [known, is_new] = writers_.try_emplace(writer.id, writer);
  if (is_new) return report(writer, WriterChange::kAppeared);
  if (known->second.qos == writer.qos && known->second.topic == writer.topic) return;
  known->second = writer;
  report(writer, WriterChange::kChanged);
}

void EndpointRegistry::note(const TopicReader& reader) {
  if (!is_wire_name(reader.topic.name) || !is_wire_name(reader.topic.type)) return;
  const std::lock_guard lock(mutex_);
  readers_.insert_or_assign(reader.id, reader);
}

void EndpointRegistry::note_gone(const WriterId& id) {
  const std::lock_guard lock(mutex_);
  readers_.erase(id);
  if (const auto gone = writers_.extract(id); !gone.empty()) report(gone.mapped(), WriterChange::kGone);
}

void EndpointRegistry::note(const ParticipantId& participant, const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (!name.empty()) participants_.insert_or_assign(participant, io::printable(name));
}

void EndpointRegistry::note_gone(const ParticipantId& participant) {
  const std::lock_guard lock(mutex_);
  participants_.erase(participant);
}

void EndpointRegistry::report(const TopicWriter& writer, WriterChange change) {
  if (watcher_) thread_->post([watcher = watcher_, writer, change] { watcher(writer, change); });
}

}  // namespace rtd::bus
