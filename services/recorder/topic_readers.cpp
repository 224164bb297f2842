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
  bus_.watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { on_writer(writer, change); });
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
  return std::ranges::all_of(writers, [this](const bus::TopicWriter& writer) {
    if (writer.own || !filter_.wants(writer.topic.name) || refused_.contains(key_of(writer.topic))) return true;
    const auto reader = readers_.find({book_.find_or_add(writer.topic.name, writer.topic.type), offer_of(writer.qos)});
    return reader != readers_.end() && reader->second->matched() > 0;
  });
}

void TopicReaders::on_writer(const bus::TopicWriter& writer, bus::WriterChange change) {
  if (change == bus::WriterChange::kGone || writer.own || !filter_.wants(writer.topic.name)) return;
  try {
    subscribe(writer);
  } catch (const bus::BusError& error) {
    const std::lock_guard lock(mutex_);
    if (refused_.insert(key_of(writer.topic)).second) {
      SPDLOG_WARN("event=topic_not_recorded topic={} type={} cause=\"{}\"", writer.topic.name, writer.topic.type,
                  error.what());
    }
  }
}

void TopicReaders::subscribe(const bus::TopicWriter& writer) {
  const std::size_t topic = book_.find_or_add(writer.topic.name, writer.topic.type);
  book_.add_offer(topic, writer.qos);
  const Offer offer = offer_of(writer.qos);
  const std::lock_guard lock(mutex_);
  if (readers_.contains({topic, offer})) return;
  const auto subscription = std::make_shared<Subscription>(Subscription{topic, offer, {}});
  bus::RawReaderOptions options;
  options.reliable = offer.first;
  options.transient_local = offer.second;
  options.in_place = in_place_ && writer.shared_memory;
  readers_[{topic, offer}] = bus_.reader(writer.topic, options, handlers(subscription));
  const RecordedTopic described = book_.topic(topic);
  SPDLOG_INFO("event=topic_found topic={} type={} reliable={} latched={}{}", described.name, described.type.name,
              offer.first, offer.second, described.type.known() ? "" : " definition=unknown");
}

bus::RawHandlers TopicReaders::handlers(const std::shared_ptr<Subscription>& subscription) {
  bus::RawHandlers handlers;
  handlers.on_sample = [this, subscription](const bus::RawSample& sample) { receive(*subscription, sample); };
  handlers.on_lost = [this, subscription](const bus::RawLoss& loss) { lose(*subscription, loss); };
  handlers.status.on_samples_lost = [this, subscription](int total) {
    // All that the transport has lost: a later message may never reveal some of it.
    book_.count(subscription->topic, [total](TopicCounts& counts) {
      counts.lost_in_transit = std::max(counts.lost_in_transit, static_cast<std::uint64_t>(total));
    });
  };
  return handlers;
}

/// Whether the writer offers exactly what this reader requests.
bool TopicReaders::is_mine(Subscription& subscription, const bus::WriterId& writer) {
  const auto known = subscription.is_mine.find(writer);
  if (known != subscription.is_mine.end()) return known->second;
  bool mine = true;  // a writer that has gone and left samples
  for (const bus::TopicWriter& other : bus_.writers()) {
    if (other.id == writer) mine = offer_of(other.qos) == subscription.offer;
  }
  return subscription.is_mine[writer] = mine;
}

void TopicReaders::receive(Subscription& subscription, const bus::RawSample& sample) {
  if (!is_mine(subscription, sample.writer)) return;
  QueuedMessage message{subscription.topic, static_cast<std::uint32_t>(sample.sequence),
                        static_cast<std::uint64_t>(sample.received_ns), static_cast<std::uint64_t>(sample.source_ns),
                        sample.bytes};
  if (queue_.push(std::move(message))) return;
  book_.count(subscription.topic, [](TopicCounts& counts) { ++counts.lost_in_queue; });
  const std::lock_guard lock(log_mutex_);
  if (!queue_log_.pass()) return;
  SPDLOG_WARN(
      "event=queue_full topic={} sequence={} cause=\"the disk is too slow\" fix=\"fewer topics (--topics) or "
      "record.queue_mib\"",
      book_.topic(subscription.topic).name, sample.sequence);
}

void TopicReaders::lose(Subscription& subscription, const bus::RawLoss& loss) {
  if (!is_mine(subscription, loss.writer)) return;
  book_.count(subscription.topic, [&](TopicCounts& counts) { counts.lost_in_transit += loss.count; });
  const std::lock_guard lock(log_mutex_);
  if (!loss_log_.pass()) return;
  SPDLOG_WARN("event=samples_lost topic={} writer={} first={} count={}", book_.topic(subscription.topic).name,
              bus::to_string(loss.writer), loss.first_sequence, loss.count);
}

}  // namespace rtd::recorder
