// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_diff.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <unordered_map>

#include "common/mcap/indexed_reader.hpp"
#include "services/recorder/inspect/payload_diff.hpp"

namespace rtd::recording {
namespace {

using Messages = std::vector<Fingerprint>;

/// Equal keys are taken in order.
MessagePairs pair_by(const Messages& a, const Messages& b, std::uint64_t Fingerprint::*key, PairedBy paired_by) {
  MessagePairs result{paired_by, {}, {}, {}};
  std::unordered_map<std::uint64_t, std::deque<std::size_t>> waiting;
  for (std::size_t i = 0; i < b.size(); ++i) waiting[b[i].*key].push_back(i);
  std::vector<bool> used(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto found = waiting.find(a[i].*key);
    if (found == waiting.end() || found->second.empty()) {
      result.only_a.push_back(i);
      continue;
    }
    result.pairs.push_back({i, found->second.front()});
    used[found->second.front()] = true;
    found->second.pop_front();
  }
  for (std::size_t i = 0; i < b.size(); ++i)
    if (!used[i]) result.only_b.push_back(i);
  return result;
}

MessagePairs pair_by_position(const Messages& a, const Messages& b) {
  MessagePairs result;
  const std::size_t both = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < both; ++i) result.pairs.push_back({i, i});
  for (std::size_t i = both; i < a.size(); ++i) result.only_a.push_back(i);
  for (std::size_t i = both; i < b.size(); ++i) result.only_b.push_back(i);
  return result;
}

/// Compares the time between neighbouring pairs in both recordings.
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

/// A copy of the payload with this fingerprint; empty when it is not found.
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

std::string name_of(PairedBy paired_by) {
  switch (paired_by) {
    case PairedBy::kPublishTime:
      return "publish time";
    case PairedBy::kContent:
      return "content";
    case PairedBy::kPosition:
      break;
  }
  return "position";
}

MessagePairs pair_messages(const TopicContents& a, const TopicContents& b) {
  const std::size_t enough = std::min(a.messages.size(), b.messages.size());
  MessagePairs by_time = pair_by(a.messages, b.messages, &Fingerprint::publish_ns, PairedBy::kPublishTime);
  if (2 * by_time.pairs.size() >= enough) return by_time;
  MessagePairs by_content = pair_by(a.messages, b.messages, &Fingerprint::key, PairedBy::kContent);
  if (2 * by_content.pairs.size() >= enough) return by_content;
  return pair_by_position(a.messages, b.messages);
}

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

void explain(RecordingDiff& diff, const io::ByteSource& a, const io::ByteSource& b) {
  mcap::IndexedReader in_a(a), in_b(b);
  for (TopicDiff& topic : diff.topics) {
    if (!topic.first) continue;
    const auto payload_a = payload_of(in_a, topic.topic, topic.first->a);
    const auto payload_b = payload_of(in_b, topic.topic, topic.first->b);
    if (payload_a && payload_b) topic.first->why = differences(topic.type_a, *payload_a, *payload_b);
  }
}

}  // namespace rtd::recording
