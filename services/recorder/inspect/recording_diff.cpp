// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_diff.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <unordered_map>

#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/stream_reader.hpp"
#include "common/service/command_line.hpp"
#include "services/recorder/inspect/payload_diff.hpp"

namespace rtd::recordings {
namespace {

using Json = nlohmann::ordered_json;
using Messages = std::vector<Fingerprint>;

constexpr std::size_t kShownFields = 8;
constexpr char kCdr[] = "cdr";

std::uint64_t hash_of(io::ByteView bytes) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::uint64_t stable_hash_of(io::ByteView payload, const std::vector<ByteRange>& left_out) {
  std::uint64_t hash = 0;
  std::size_t from = 0;
  const auto add = [&](std::size_t to) { hash = hash * 31 + hash_of(payload.subspan(from, to - from)); };
  for (const ByteRange& range : left_out) {
    if (range.end > payload.size()) break;
    add(range.begin);
    from = range.end;
  }
  add(payload.size());
  return hash;
}

Fingerprint fingerprint(const mcap::Message& message, const std::vector<ByteRange>& of_the_run) {
  Fingerprint print{message.log_time, message.publish_time, message.sequence, message.data.size()};
  print.hash = hash_of(message.data);
  print.stable_hash = of_the_run.empty() ? print.hash : stable_hash_of(message.data, of_the_run);
  constexpr std::size_t kHeaderBytes = 4;
  if (message.data.size() >= kHeaderBytes + sizeof(print.key))
    print.key = io::load<std::uint64_t>(message.data.data() + kHeaderBytes);
  return print;
}

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

std::string joined(const std::set<std::string>& encodings) {
  return fmt::format("{}", fmt::join(encodings, ","));
}

std::string verdict(const TopicDiff& topic, const DiffOptions& options) {
  if (topic.equal(options)) return "equal";
  if (topic.messages_a == 0) return "only in B";
  if (topic.messages_b == 0) return "only in A";
  if (topic.type_a != topic.type_b) return "differs in type: " + topic.type_a + " | " + topic.type_b;
  if (topic.encoding_a != topic.encoding_b)
    return "differs in encoding: " + topic.encoding_a + " | " + topic.encoding_b;
  return "differs";
}

std::string row(const TopicDiff& topic, const DiffOptions& options, std::size_t width) {
  const std::string payloads = topic.run_fields_only > 0
                                   ? fmt::format("{} ({} of the run)", topic.payloads, topic.run_fields_only)
                                   : std::to_string(topic.payloads);
  return fmt::format("{:<{}} {:>8} {:>8} {:>8} {:>8} {:>18} {:>8} {:>8} {:>9.2f} {:>9.2f}  {}\n", topic.topic, width,
                     topic.messages_a, topic.messages_b, topic.only_a, topic.only_b, payloads, topic.stamps,
                     topic.out_of_order, topic.timing_p50_ms, topic.timing_p99_ms, verdict(topic, options));
}

std::string first_text(const TopicDiff& topic) {
  if (!topic.first) return "";
  const MessagePlace& first = *topic.first;
  std::string text =
      fmt::format("\n{}: first different payload: message {} in A ({}), {} in B, paired by {}\n", topic.topic,
                  first.index_a, service::time_text(first.a.log_ns), first.index_b, name_of(topic.paired_by));
  for (std::size_t i = 0; i < std::min(first.why.size(), kShownFields); ++i) text += "  " + first.why[i] + "\n";
  if (first.why.size() > kShownFields)
    text += fmt::format("  and {} more fields (--json lists all)\n", first.why.size() - kShownFields);
  return text;
}

std::string missing_text(const TopicDiff& topic) {
  if (!topic.first_missing || topic.messages_a == 0 || topic.messages_b == 0) return "";
  return fmt::format("\n{}: first message without a partner: number {} of {}\n", topic.topic, *topic.first_missing,
                     topic.only_a > 0 ? "A" : "B");
}

Json first_json(const TopicDiff& topic) {
  if (!topic.first) return nullptr;
  const MessagePlace& first = *topic.first;
  return {{"index_a", first.index_a},   {"index_b", first.index_b},           {"log_ns_a", first.a.log_ns},
          {"log_ns_b", first.b.log_ns}, {"publish_ns_a", first.a.publish_ns}, {"publish_ns_b", first.b.publish_ns},
          {"bytes_a", first.a.bytes},   {"bytes_b", first.b.bytes},           {"why", first.why}};
}

}  // namespace

Contents contents_of(const io::ByteSource& source, const std::function<void(std::uint64_t bytes)>& on_progress) {
  Contents contents;
  struct Target {
    TopicContents* topic = nullptr;
    std::vector<ByteRange> of_the_run;
  };
  std::map<mcap::ChannelId, Target> targets;
  mcap::StreamReader reader(source);
  while (const mcap::Record* record = reader.next()) {
    if (on_progress) on_progress(reader.bytes_read());
    const auto* message = std::get_if<mcap::Message>(record);
    if (message == nullptr) continue;
    Target& target = targets[message->channel_id];
    if (target.topic == nullptr) {
      const mcap::Channel& channel = reader.channels().at(message->channel_id);
      target.topic = &contents.topics[channel.topic];
      const auto schema = reader.schemas().find(channel.schema_id);
      if (schema != reader.schemas().end()) target.topic->type = schema->second.name;
      target.topic->encodings.insert(channel.message_encoding);
      if (channel.message_encoding == kCdr) target.of_the_run = run_ranges(target.topic->type);
    }
    target.topic->messages.push_back(fingerprint(*message, target.of_the_run));
  }
  contents.problems = reader.problems().listed();
  contents.data_lost = reader.problems().data_lost();
  return contents;
}

std::string name_of(PairedBy paired_by) {
  if (paired_by == PairedBy::kPosition) return "position";
  return paired_by == PairedBy::kContent ? "content" : "publish time";
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
  return type_a == type_b && encoding_a == encoding_b && only_a == 0 && only_b == 0 && counted == 0 &&
         out_of_order == 0 && (stamps == 0 || options.ignore_stamps);
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
    TopicDiff of_topic{topic,
                       in_a.type,
                       in_b.type,
                       joined(in_a.encodings),
                       joined(in_b.encodings),
                       in_a.messages.size(),
                       in_b.messages.size()};
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
    const bool decodable = topic.encoding_a == kCdr && topic.encoding_b == kCdr;
    if (payload_a && payload_b) topic.first->why = differences(decodable ? topic.type_a : "", *payload_a, *payload_b);
  }
}

std::string to_text(const RecordingDiff& diff) {
  std::size_t width = 5;
  for (const TopicDiff& topic : diff.topics) width = std::max(width, topic.topic.size());
  std::string text =
      fmt::format("{:<{}} {:>8} {:>8} {:>8} {:>8} {:>18} {:>8} {:>8} {:>9} {:>9}\n", "topic", width, "in A", "in B",
                  "only A", "only B", "payloads differ", "stamps", "order", "dt p50 ms", "p99 ms");
  for (const TopicDiff& topic : diff.topics) text += row(topic, diff.options, width);
  for (const TopicDiff& topic : diff.topics) text += missing_text(topic) + first_text(topic);
  return text +
         "dt: by how much the log time between messages differs from the other recording (does not count as a "
         "difference)\n" +
         (diff.equal() ? "equal\n" : "");
}

Json to_json(const RecordingDiff& diff) {
  Json json = {{"kind", "recordings"}, {"equal", diff.equal()}, {"topics", Json::array()}};
  for (const TopicDiff& topic : diff.topics)
    json["topics"].push_back({{"topic", topic.topic},
                              {"equal", topic.equal(diff.options)},
                              {"type_a", topic.type_a},
                              {"type_b", topic.type_b},
                              {"encoding_a", topic.encoding_a},
                              {"encoding_b", topic.encoding_b},
                              {"messages_a", topic.messages_a},
                              {"messages_b", topic.messages_b},
                              {"paired_by", name_of(topic.paired_by)},
                              {"only_a", topic.only_a},
                              {"only_b", topic.only_b},
                              {"payloads_differ", topic.payloads},
                              {"of_these_run_fields_only", topic.run_fields_only},
                              {"publish_times_differ", topic.stamps},
                              {"out_of_order", topic.out_of_order},
                              {"inter_message_error_ms", {{"p50", topic.timing_p50_ms}, {"p99", topic.timing_p99_ms}}},
                              {"first_missing", topic.first_missing ? Json(*topic.first_missing) : Json(nullptr)},
                              {"first_difference", first_json(topic)}});
  return json;
}

}  // namespace rtd::recordings
