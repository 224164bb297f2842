// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/topic_readers.hpp"

#include <algorithm>

#include "common/bus/backend.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::recorder {
namespace {

std::pair<bool, bool> offer_of(const bus::RawQos& qos) {
  return {qos.reliable, qos.durability != bus::RawQos::Durability::kVolatile};
}

std::string key_of(const bus::RawTopic& topic) {
  return topic.name + ' ' + topic.type;
}

}  // namespace

TopicReaders::TopicReaders(bus::RawBus& bus, TopicFilter filter, bool in_place, TopicRegistry& book,
                           MessageQueue& queue)
    : bus_(bus), filter_(std::move(filter)), in_place_(in_place), book_(book), queue_(queue) {
  bus_.watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { on_writer(writer, change); });
}

void TopicReaders::stop() {
  bus_.watch(nullptr);
  std::unique_ptr<bus::RawReader> schema_reader;
  {
    const std::lock_guard lock(mutex_);
    schema_reader = std::move(schema_reader_);
  }
  schema_reader.reset();  // its thread may be subscribing and needs the lock
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
    if (writer.own || writer.topic.name == ros2::kSchemasTopic || !filter_.wants(writer.topic.name)) return true;
    if (refused_.contains(key_of(writer.topic))) return true;
    const auto reader = readers_.find({book_.find_or_add(writer.topic.name, writer.topic.type), offer_of(writer.qos)});
    return reader != readers_.end() && reader->second->matched() > 0;
  });
}

void TopicReaders::on_writer(const bus::TopicWriter& writer, bus::WriterChange change) {
  if (writer.topic.name == ros2::kSchemasTopic) return on_schema_writer(writer, change);
  if (change == bus::WriterChange::kGone || writer.own || !filter_.wants(writer.topic.name)) return;
  if (!postpone(writer)) try_to_subscribe(writer);
}

/// A writer of another kind, that is not ours, would let topics wait in vain.
void TopicReaders::on_schema_writer(const bus::TopicWriter& writer, bus::WriterChange change) {
  const bool latched = writer.qos.reliable && writer.qos.durability != bus::RawQos::Durability::kVolatile;
  if (writer.own || writer.topic.type != ros2::kSchemasType || !latched) return;
  if (change == bus::WriterChange::kAppeared) {
    listen_to_schemas(writer);
  } else if (change == bus::WriterChange::kGone) {
    {
      const std::lock_guard lock(mutex_);
      schemas_read_.erase(writer.id);
    }
    subscribe_postponed();
  }
}

void TopicReaders::listen_to_schemas(const bus::TopicWriter& writer) {
  const std::lock_guard lock(mutex_);
  try {
    if (!schema_reader_) {
      bus::RawHandlers handlers;
      handlers.on_sample = [this](const bus::RawSample& sample) { learn(sample); };
      schema_reader_ = bus_.reader(writer.topic, {.reliable = true, .transient_local = true}, std::move(handlers));
    }
    schemas_read_.try_emplace(writer.id, false);  // the sample may be faster
  } catch (const bus::BusError& error) {
    SPDLOG_WARN("event=schemas_not_read topic={} cause=\"{}\"", writer.topic.name, error.what());
  }
}

void TopicReaders::learn(const bus::RawSample& sample) {
  try {
    for (const auto& [dds_type, definition] : ros2::decode_schemas(sample.cdr())) book_.learn(dds_type, definition);
  } catch (const ros::WireError& error) {
    SPDLOG_WARN("event=schemas_not_read topic={} cause=\"{}\"", ros2::kSchemasTopic, error.what());
  }
  {
    const std::lock_guard lock(mutex_);
    schemas_read_[sample.writer] = true;
  }
  subscribe_postponed();
}

/// True when the text of its type may still come.
bool TopicReaders::postpone(const bus::TopicWriter& writer) {
  const std::lock_guard lock(mutex_);
  if (!schemas_may_come() || book_.knows(writer.topic.type)) return false;
  postponed_.push_back(writer);
  return true;
}

bool TopicReaders::schemas_may_come() const {
  return std::ranges::any_of(schemas_read_, [](const auto& writer) { return !writer.second; });
}

void TopicReaders::tick(std::int64_t now_ns) {
  constexpr std::int64_t kPatienceNs = 2'000'000'000;
  {
    const std::lock_guard lock(mutex_);
    if (postponed_.empty()) return;
    if (postponed_ns_ == 0) postponed_ns_ = now_ns;
    if (now_ns - postponed_ns_ < kPatienceNs) return;
    for (auto& [writer, read] : schemas_read_) read = true;
  }
  subscribe_postponed();
}

void TopicReaders::subscribe_postponed() {
  std::vector<bus::TopicWriter> postponed;
  {
    const std::lock_guard lock(mutex_);
    if (schemas_may_come()) return;
    postponed_ns_ = 0;
    postponed.swap(postponed_);
  }
  for (const bus::TopicWriter& writer : postponed) try_to_subscribe(writer);
}

void TopicReaders::try_to_subscribe(const bus::TopicWriter& writer) {
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
