// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/traffic.hpp"

#include <algorithm>

namespace rtd::bus {

std::optional<ParticipantId> Input::source() const {
  const std::lock_guard lock(mutex_);
  return source_;
}

std::optional<std::uint64_t> Input::received(const ParticipantId& connection) const {
  const std::lock_guard lock(mutex_);
  const auto known = counts_.find(connection);
  const bool follows_another = gated_ && source_ && *source_ != connection && has_writer(*source_);
  if (known == counts_.end() || follows_another || handles_) return std::nullopt;
  return known->second.received;
}

StatusCallbacks Input::counting(StatusCallbacks callbacks) {
  StatusCallbacks counted = callbacks;
  const auto self = shared_from_this();
  counted.on_writer = [self, next = std::move(callbacks.on_writer)](const WriterId& writer, bool matched) {
    self->note_writer(participant_of(writer), matched);
    if (next) next(writer, matched);
  };
  counted.accepts = [self, next = std::move(callbacks.accepts)](const WriterId& writer) {
    const bool taken = !next || next(writer);
    self->note_message(participant_of(writer), taken);
    return taken;
  };
  return counted;
}

ErasedCallback Input::counting(ErasedCallback on_message) {
  return [self = shared_from_this(), on_message = std::move(on_message)](std::shared_ptr<const void> message,
                                                                         const WriterId& writer) {
    self->handles_ = true;
    on_message(std::move(message), writer);
    self->handles_ = false;
  };
}

void Input::note_writer(const ParticipantId& connection, bool matched) {
  const std::lock_guard lock(mutex_);
  Count& count = count_of(connection);
  count.writers = std::max(0, count.writers + (matched ? 1 : -1));
  if (count.writers == 0 && count.received == 0) counts_.erase(connection);
}

void Input::note_message(const ParticipantId& connection, bool taken) {
  const std::lock_guard lock(mutex_);
  ++count_of(connection).received;
  if (taken) source_ = connection;
}

/// A new one makes room where many have come and gone.
Input::Count& Input::count_of(const ParticipantId& connection) {
  constexpr std::size_t kMax = 64;
  if (counts_.size() >= kMax && !counts_.contains(connection)) {
    std::erase_if(counts_, [this](const auto& entry) { return entry.second.writers == 0 && entry.first != source_; });
  }
  return counts_[connection];
}

/// Under the lock.
bool Input::has_writer(const ParticipantId& connection) const {
  const auto known = counts_.find(connection);
  return known != counts_.end() && known->second.writers > 0;
}

Traffic::Sent Traffic::output(const std::string& topic) {
  const std::lock_guard lock(mutex_);
  Sent& sent = outputs_[topic];
  if (!sent) sent = std::make_shared<std::atomic<std::uint64_t>>(0);
  return sent;
}

std::shared_ptr<Input> Traffic::input(const std::string& topic, bool gated) {
  auto input = std::make_shared<Input>(topic, gated);
  const std::lock_guard lock(mutex_);
  std::erase_if(inputs_, [](const auto& known) { return known.expired(); });
  inputs_.push_back(input);
  return input;
}

std::map<std::string, std::uint64_t> Traffic::sent() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::uint64_t> counts;
  for (const auto& [topic, sent] : outputs_) {
    if (*sent > 0) counts[topic] = *sent;
  }
  return counts;
}

std::vector<std::shared_ptr<const Input>> Traffic::inputs() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<const Input>> living;
  for (const auto& known : inputs_) {
    if (auto input = known.lock()) living.push_back(std::move(input));
  }
  return living;
}

}  // namespace rtd::bus
