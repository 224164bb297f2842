// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/prefixed_calls.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/bus/commands.hpp"

namespace rtd::bus {
namespace {

constexpr std::size_t kHeader = ByteBlock::kCdrHeaderBytes, kNumber = 8, kPrefix = 2 * kNumber;

/// Numbers of a sample in the other byte order.
void reverse_numbers(std::byte* prefix) {
  std::reverse(prefix, prefix + kNumber);
  std::reverse(prefix + kNumber, prefix + kPrefix);
}

}  // namespace

bool is_prefixed(const CallId& id) {
  return std::all_of(id.client.begin() + kNumber, id.client.end(), [](std::uint8_t byte) { return byte == 0; });
}

std::vector<std::byte> with_prefix(const CallId& id, std::span<const std::byte> cdr) {
  std::vector<std::byte> sample(cdr.begin(), cdr.end());
  sample.insert(sample.begin() + kHeader, kPrefix, std::byte{0});
  std::memcpy(sample.data() + kHeader, id.client.data(), kNumber);
  std::memcpy(sample.data() + kHeader + kNumber, &id.sequence, kNumber);
  return sample;
}

std::optional<PrefixedCall> split_prefix(std::span<const std::byte> sample) {
  if (sample.size() < kHeader + kPrefix) return std::nullopt;
  std::array<std::byte, kPrefix> prefix{};
  std::copy_n(sample.begin() + kHeader, kPrefix, prefix.begin());
  const bool little_endian = (std::to_integer<unsigned>(sample[1]) & 1U) != 0;
  if (!little_endian) reverse_numbers(prefix.data());
  PrefixedCall call;
  std::memcpy(call.id.client.data(), prefix.data(), kNumber);
  std::memcpy(&call.id.sequence, prefix.data() + kNumber, kNumber);
  call.cdr.assign(sample.begin(), sample.begin() + kHeader);
  call.cdr.insert(call.cdr.end(), sample.begin() + kHeader + kPrefix, sample.end());
  return call;
}

PrefixedCalls::PrefixedCalls(CallRole role, std::uint64_t client, std::unique_ptr<RawWriter> writer,
                             const MakeReader& make_reader, OnCall on_call)
    : role_(role), on_call_(std::move(on_call)), writer_(std::move(writer)) {
  std::memcpy(last_.client.data(), &client, sizeof(client));
  RawHandlers handlers;
  handlers.on_sample = [this](const RawSample& sample) { receive(sample); };
  reader_ = make_reader(std::move(handlers));
}

std::optional<CallId> PrefixedCalls::request(std::span<const std::byte> cdr) {
  const std::lock_guard lock(mutex_);
  ++last_.sequence;
  if (!writer_->write(with_prefix(last_, cdr))) return std::nullopt;
  return last_;
}

bool PrefixedCalls::reply(const CallId& id, std::span<const std::byte> cdr) {
  return writer_->write(with_prefix(id, cdr));
}

void PrefixedCalls::receive(const RawSample& sample) const {
  const std::optional<PrefixedCall> call = split_prefix(sample.cdr());
  const bool for_us = call && (role_ == CallRole::kServer || call->id.client == last_.client);
  if (for_us) on_call_(call->id, call->cdr);
}

RawReaderOptions call_reader_options(CallRole role) {
  // A request that is a little longer than a server takes still gets an answer that says so.
  constexpr std::size_t kLargestRequest = 2 * kMaxRequestBytes, kLargestReply = 16 * kMaxRequestBytes;
  RawReaderOptions options;
  options.depth = kCallDepth;
  options.largest_sample = role == CallRole::kServer ? kLargestRequest : kLargestReply;
  return options;
}

RawWriterOptions call_writer_options() {
  RawWriterOptions options;
  options.qos.depth = kCallDepth;
  return options;
}

RawTopic received_topic(const CallTopics& topics, CallRole role) {
  if (role == CallRole::kServer) return {topics.request, topics.request_type};
  return {topics.reply, topics.reply_type};
}

RawTopic sent_topic(const CallTopics& topics, CallRole role) {
  return received_topic(topics, role == CallRole::kServer ? CallRole::kClient : CallRole::kServer);
}

}  // namespace rtd::bus
