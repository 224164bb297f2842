// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "common/service/command_line.hpp"
#include "services/recorder/inspect/recording_diff.hpp"

namespace rtd::recording {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShownFields = 8;

std::string verdict(const TopicDiff& topic, const DiffOptions& options) {
  if (topic.equal(options)) return "equal";
  if (topic.messages_a == 0) return "only in B";
  if (topic.messages_b == 0) return "only in A";
  return topic.type_a == topic.type_b ? "differs" : "differs in type: " + topic.type_a + " | " + topic.type_b;
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

}  // namespace rtd::recording
