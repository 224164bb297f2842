// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/message_feed.hpp"

#include <algorithm>
#include <utility>

namespace rtd::replay {

MessageFeed::MessageFeed(mcap::IndexedReader& reader, FeedOptions options)
    : reader_(reader), options_(std::move(options)), seek_ns_(options_.start_ns), thread_([this] { read_all(); }) {}

MessageFeed::~MessageFeed() {
  close();
  thread_.join();
}

std::optional<PlayedMessage> MessageFeed::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || at_end_ || !messages_.empty(); });
  if (closed_ || messages_.empty()) return std::nullopt;
  PlayedMessage message = std::move(messages_.front());
  messages_.pop_front();
  bytes_ -= message.cdr->size();
  changed_.notify_all();
  return message;
}

void MessageFeed::seek(std::int64_t log_ns) {
  const std::lock_guard lock(mutex_);
  ++generation_;
  seek_ns_ = std::clamp(log_ns, options_.start_ns, options_.end_ns);
  messages_.clear();
  bytes_ = 0;
  at_end_ = false;
  changed_.notify_all();
}

void MessageFeed::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void MessageFeed::read_all() {
  std::uint64_t generation = 0;
  while (const std::optional<std::int64_t> from_ns = wait_for_seek(generation)) read_from(*from_ns, generation);
}

std::optional<std::int64_t> MessageFeed::wait_for_seek(std::uint64_t& generation) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || generation_ != generation; });
  if (closed_) return std::nullopt;
  generation = generation_;
  return seek_ns_;
}

void MessageFeed::read_from(std::int64_t log_ns, std::uint64_t generation) {
  mcap::MessageCursor messages = reader_.messages(
      {static_cast<mcap::Timestamp>(log_ns), static_cast<mcap::Timestamp>(options_.end_ns), options_.wanted});
  while (const mcap::Message* message = messages.next()) {
    auto cdr = std::make_shared<const std::vector<std::byte>>(message->data.begin(), message->data.end());
    if (!put({message->channel_id, static_cast<std::int64_t>(message->log_time),
              static_cast<std::int64_t>(message->publish_time), std::move(cdr)},
             generation))
      return;
  }
  const std::lock_guard lock(mutex_);
  if (generation_ == generation) at_end_ = true;
  changed_.notify_all();
}

/// False when the rest is not needed: closed, or a new seek.
bool MessageFeed::put(PlayedMessage message, std::uint64_t generation) {
  std::unique_lock lock(mutex_);
  const std::uint64_t size = message.cdr->size();
  changed_.wait(lock, [&] {
    return closed_ || generation_ != generation || messages_.empty() || bytes_ + size <= options_.read_ahead_bytes;
  });
  if (closed_ || generation_ != generation) return false;
  bytes_ += size;
  messages_.push_back(std::move(message));
  changed_.notify_all();
  return true;
}

}  // namespace rtd::replay
