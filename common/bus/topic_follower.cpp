// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/topic_follower.hpp"

#include <utility>

namespace rtd::bus {

TopicFollower::TopicFollower(RawBus& bus, Options options) : bus_(bus), options_(std::move(options)) {
  bus_.watch([this](const TopicWriter& writer, WriterChange change) {
    if (writer.own) return;
    options_.run([this, writer, change] {
      if (stopped_ || !options_.wants(writer)) return;
      change == WriterChange::kGone ? remove(writer) : add(writer);
    });
  });
}

std::function<void(std::function<void()>)> TopicFollower::under(std::mutex& mutex) {
  return [&mutex](const std::function<void()>& change) {
    const std::lock_guard lock(mutex);
    change();
  };
}

void TopicFollower::stop() {
  if (stopped_) return;
  bus_.watch(nullptr);
  stopped_ = true;
  topics_.clear();
}

void TopicFollower::add(const TopicWriter& writer) {
  Followed& followed = topics_[writer.topic.name];
  if (followed.writers.empty() && followed.topic != writer.topic)
    followed = {writer.topic, {}, options_.reader, nullptr};
  if (followed.topic.type != writer.topic.type) return;
  followed.writers.insert_or_assign(writer.id, writer);
  try {
    options_.on_writer(writer);
    if (!options_.on_demand || reads(writer.topic.name)) read_from(followed, writer);
  } catch (const BusError& error) {
    options_.on_refused(writer, error);
  }
}

void TopicFollower::remove(const TopicWriter& writer) {
  const auto found = topics_.find(writer.topic.name);
  if (found == topics_.end() || found->second.writers.erase(writer.id) == 0) return;
  if (!options_.on_demand || !found->second.writers.empty()) return;
  topics_.erase(found);
  options_.on_gone(writer.topic);
}

void TopicFollower::read(const std::string& topic, bool wanted) {
  if (wanted == reads(topic)) return;
  if (wanted) {
    wanted_.insert(topic);
  } else {
    wanted_.erase(topic);
  }
  const auto found = topics_.find(topic);
  if (found == topics_.end()) return;
  Followed& followed = found->second;
  followed.reader.reset();
  followed.options = options_.reader;
  if (!wanted) return;
  for (const auto& [id, writer] : followed.writers) {
    try {
      read_from(followed, writer);
    } catch (const BusError& error) {
      options_.on_refused(writer, error);
    }
  }
}

void TopicFollower::read_from(Followed& followed, const TopicWriter& writer) {
  RawReaderOptions options = followed.options;
  options.reliable = options.reliable && writer.qos.reliable;
  options.transient_local = options.transient_local && writer.qos.durability != RawQos::Durability::kVolatile;
  options.in_place = options.in_place && writer.shared_memory;
  if (!followed.reader || options != followed.options) {
    followed.options = options;
    followed.reader.reset();
    followed.reader = bus_.reader(followed.topic, options, options_.handlers(followed.topic));
  }
  options_.on_read(writer, options);
}

const TopicFollower::Writers& TopicFollower::writers(const std::string& topic) const {
  static const Writers kNone;
  const auto found = topics_.find(topic);
  return found == topics_.end() ? kNone : found->second.writers;
}

std::vector<std::string> TopicFollower::topics() const {
  std::vector<std::string> names;
  for (const auto& [name, followed] : topics_) names.push_back(name);
  return names;
}

}  // namespace rtd::bus
