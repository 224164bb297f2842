// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_diff.hpp"

#include <algorithm>
#include <cmath>

#include "common/mcap/indexed_reader.hpp"
#include "services/recorder/inspect/payload_diff.hpp"

namespace rtd::recording {
namespace {

/// The distances of neighbouring pairs in both recordings, compared.
void compare_timing(TopicDiff& result, const TopicContents& a, const TopicContents& b, const MessagePairs& paired) {
  const auto signed_gap = [](const Fingerprint& from, const Fingerprint& to) {
    return static_cast<double>(static_cast<std::int64_t>(to.log_ns - from.log_ns));
  };
  std::vector<double> errors_ms;
  for (std::size_t i = 1; i < paired.pairs.size(); ++i) {
    const MessagePair &before = paired.pairs[i - 1], &pair = paired.pairs[i];
    const double gap_a = signed_gap(a.messages[before.a], a.messages[pair.a]);
    const double gap_b = signed_gap(b.messages[before.b], b.messages[pair.b]);
    errors_ms.push_back(std::abs(gap_b - gap_a) * 1e-6);
  }
  if (errors_ms.empty()) return;
  std::ranges::sort(errors_ms);
  result.timing_p50_ms = errors_ms[errors_ms.size() / 2];
  result.timing_p99_ms = errors_ms[errors_ms.size() * 99 / 100];
}

void compare(TopicDiff& result, const TopicContents& a, const TopicContents& b, const DiffOptions& options) {
  const MessagePairs paired = pair_messages(a, b);
  result.paired_by = paired.paired_by;
  result.only_a = paired.only_a.size();
  result.only_b = paired.only_b.size();
  if (!paired.only_a.empty()) result.first_missing = paired.only_a.front();
  if (paired.only_a.empty() && !paired.only_b.empty()) result.first_missing = paired.only_b.front();
  compare_timing(result, a, b, paired);
  std::size_t farthest_b = 0;
  for (const MessagePair& pair : paired.pairs) {
    const Fingerprint &x = a.messages[pair.a], &y = b.messages[pair.b];
    result.out_of_order += pair.b < farthest_b ? 1 : 0;
    farthest_b = std::max(farthest_b, pair.b);
    result.stamps += x.publish_ns != y.publish_ns ? 1 : 0;
    if (x.hash == y.hash && x.bytes == y.bytes) continue;
    const bool run_fields_only = x.stable_hash == y.stable_hash && x.bytes == y.bytes;
    ++result.payloads;
    result.run_fields_only += run_fields_only ? 1 : 0;
    if (!result.first && !(run_fields_only && options.ignore_run_fields))
      result.first = MessagePlace{pair.a, pair.b, x, y, {}};
  }
}

/// A copy of the payload with this fingerprint; empty when it is not found any more.
std::optional<std::vector<std::byte>> payload_of(mcap::IndexedReader& reader, const std::string& topic,
                                                 const Fingerprint& print) {
  mcap::MessageCursor messages = reader.messages(
      {print.log_ns, print.log_ns, [&](const mcap::Channel& channel) { return channel.topic == topic; }});
  while (const mcap::Message* message = messages.next())
    if (message->publish_time == print.publish_ns && message->sequence == print.sequence)
      return std::vector<std::byte>(message->data.begin(), message->data.end());
  return std::nullopt;
}

}  // namespace

bool TopicDiff::equal(const DiffOptions& options) const {
  const std::size_t counted = options.ignore_run_fields ? payloads - run_fields_only : payloads;
  return type_a == type_b && only_a == 0 && only_b == 0 && counted == 0 && out_of_order == 0 &&
         (stamps == 0 || options.ignore_stamps);
}

bool RecordingDiff::equal() const {
  return std::ranges::all_of(topics, [this](const TopicDiff& topic) { return topic.equal(options); });
}

RecordingDiff diff(const Contents& a, const Contents& b, const DiffOptions& options) {
  RecordingDiff result{options, {}};
  std::map<std::string, std::pair<const TopicContents*, const TopicContents*>> both;
  for (const auto& [topic, contents] : a.topics) both[topic].first = &contents;
  for (const auto& [topic, contents] : b.topics) both[topic].second = &contents;
  const TopicContents none;
  for (const auto& [topic, contents] : both) {
    const TopicContents& in_a = contents.first != nullptr ? *contents.first : none;
    const TopicContents& in_b = contents.second != nullptr ? *contents.second : none;
    TopicDiff of_topic{topic, in_a.type, in_b.type, in_a.messages.size(), in_b.messages.size()};
    compare(of_topic, in_a, in_b, options);
    result.topics.push_back(std::move(of_topic));
  }
  return result;
}

void explain(RecordingDiff& diff, const mcap::ByteSource& a, const mcap::ByteSource& b) {
  mcap::IndexedReader in_a(a), in_b(b);
  for (TopicDiff& topic : diff.topics) {
    if (!topic.first) continue;
    const auto payload_a = payload_of(in_a, topic.topic, topic.first->a);
    const auto payload_b = payload_of(in_b, topic.topic, topic.first->b);
    if (payload_a && payload_b) topic.first->why = differences(topic.type_a, *payload_a, *payload_b);
  }
}

}  // namespace rtd::recording
