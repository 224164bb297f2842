// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/topic_readers.hpp"

#include <algorithm>

#include "common/bus/backend.hpp"

namespace rtd::recorder {
namespace {

std::pair<bool, bool> offer_of(const bus::RawQos& qos) {
  return {qos.reliable, qos.durability != bus::RawQos::Durability::kVolatile};
}

std::string key_of(const bus::RawTopic& topic) {
  return topic.name + ' ' + topic.type;
}

}  // namespace

TopicReaders::TopicReaders(bus::RawBus& bus, TopicFilter filter, bool in_place, TopicBook& book, MessageQueue& queue)
    : bus_(bus), filter_(std::move(filter)), in_place_(in_place), book_(book), queue_(queue) {
  bus_.watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { take_note(writer, change); });
}

void TopicReaders::stop() {
  bus_.watch(nullptr);
  const std::lock_guard lock(mutex_);
  readers_.clear();
}

bool TopicReaders::any() const {
  const std::lock_guard lock(mutex_);
  return !readers_.empty();
}

bool TopicReaders::settled() const {
  const std::vector<bus::TopicWriter> writers = bus_.writers();
  const std::lock_guard lock(mutex_);
  return std::all_of(writers.begin(), writers.end(), [this](const bus::TopicWriter& writer) {
    if (writer.own || !filter_.wants(writer.topic.name) || refused_.contains(key_of(writer.topic))) return true;
    const auto reader = readers_.find({book_.find_or_add(writer.topic.name, writer.topic.type), offer_of(writer.qos)});
    return reader != readers_.end() && reader->second->matched() > 0;
  });
}

void TopicReaders::take_note(const bus::TopicWriter& writer, bus::WriterChange change) {
  if (change == bus::WriterChange::kGone || writer.own || !filter_.wants(writer.topic.name)) return;
  try {
    listen(writer);
  } catch (const bus::BusError& error) {
    const std::lock_guard lock(mutex_);
    if (refused_.insert(key_of(writer.topic)).second) {
      SPDLOG_WARN("event=topic_not_recorded topic={} type={} cause=\"{}\"", writer.topic.name, writer.topic.type,
                  error.what());
    }
  }
}

void TopicReaders::listen(const bus::TopicWriter& writer) {
  const std::size_t topic = book_.find_or_add(writer.topic.name, writer.topic.type);
  book_.add_offer(topic, writer.qos);
  const Offer offer = offer_of(writer.qos);
  const std::lock_guard lock(mutex_);
  if (readers_.contains({topic, offer})) return;
  const auto listener = std::make_shared<Listener>(Listener{topic, offer, {}});
  bus::RawReaderOptions options;
  options.reliable = offer.first;
  options.transient_local = offer.second;
  options.in_place = in_place_ && writer.shared_memory;
  readers_[{topic, offer}] = bus_.reader(writer.topic, options, handlers(listener));
  const RecordedTopic described = book_.topic(topic);
  SPDLOG_INFO("event=topic_found topic={} type={} reliable={} latched={}{}", described.name, described.type.name,
              offer.first, offer.second, described.type.known() ? "" : " definition=unknown");
}

bus::RawHandlers TopicReaders::handlers(const std::shared_ptr<Listener>& listener) {
  bus::RawHandlers handlers;
  handlers.on_sample = [this, listener](const bus::RawSample& sample) { receive(*listener, sample); };
  handlers.on_lost = [this, listener](const bus::RawLoss& loss) { lose(*listener, loss); };
  handlers.status.on_samples_lost = [this, listener](int total) {
    book_.at_least_lost_in_transit(listener->topic, static_cast<std::uint64_t>(total));
  };
  return handlers;
}

/// Whether the writer offers just what this reader asks for.
bool TopicReaders::is_mine(Listener& listener, const bus::WriterId& writer) {
  const auto known = listener.is_mine.find(writer);
  if (known != listener.is_mine.end()) return known->second;
  bool mine = true;  // a writer that is gone already and left samples
  for (const bus::TopicWriter& other : bus_.writers()) {
    if (other.id == writer) mine = offer_of(other.qos) == listener.offer;
  }
  return listener.is_mine[writer] = mine;
}

void TopicReaders::receive(Listener& listener, const bus::RawSample& sample) {
  if (!is_mine(listener, sample.writer)) return;
  QueuedMessage message{listener.topic, static_cast<std::uint32_t>(sample.sequence),
                        static_cast<std::uint64_t>(sample.received_ns), static_cast<std::uint64_t>(sample.source_ns),
                        sample.bytes};
  if (queue_.push(std::move(message))) return;
  book_.count_lost_in_queue(listener.topic);
  const std::lock_guard lock(log_mutex_);
  if (!queue_log_.pass()) return;
  SPDLOG_WARN(
      "event=queue_full topic={} sequence={} cause=\"the disk is too slow\" fix=\"fewer topics (--topics) or "
      "record.queue_mib\"",
      book_.topic(listener.topic).name, sample.sequence);
}

void TopicReaders::lose(Listener& listener, const bus::RawLoss& loss) {
  if (!is_mine(listener, loss.writer)) return;
  book_.count_lost_in_transit(listener.topic, loss.count);
  const std::lock_guard lock(log_mutex_);
  if (!loss_log_.pass()) return;
  SPDLOG_WARN("event=samples_lost topic={} writer={} first={} count={}", book_.topic(listener.topic).name,
              bus::to_string(loss.writer), loss.first_sequence, loss.count);
}

}  // namespace rtd::recorder
