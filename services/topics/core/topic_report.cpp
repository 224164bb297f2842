// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/core/topic_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/ros2/message_json.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/type_description.hpp"
#include "common/service/command_line.hpp"
#include "common/service/json_text.hpp"

namespace rtd::topics {
namespace {

using Json = nlohmann::ordered_json;

std::string value_text(const Json& value, Detail detail) {
  constexpr double kDigits = 1e6;  // behind the point: a micrometre
  if (value.is_number_float()) {
    double number = value.get<double>();
    if (detail == Detail::kReadable && std::abs(number) < 1e9 && std::abs(number) > 1 / kDigits)
      number = std::round(number * kDigits) / kDigits;
    return fmt::format("{}", number);  // the shortest that reads back the same
  }
  if (value.is_string() && (value == "nan" || value == "inf" || value == "-inf")) return '.' + value.get<std::string>();
  return service::json_line(value);
}

/// {"sec": 1, "nanosec": 5} of ROS.
bool is_time(const Json& value) {
  return value.is_object() && value.size() == 2 && value.contains("sec") && value.contains("nanosec") &&
         value["sec"].is_number_integer() && value["nanosec"].is_number_unsigned();
}

std::string time_text(const Json& time) {
  const auto sec = time["sec"].get<std::int64_t>();
  const auto nanosec = time["nanosec"].get<std::uint64_t>();
  if (sec < 0) return fmt::format("{} s + {} ns", sec, nanosec);
  return service::time_text(static_cast<std::uint64_t>(sec) * 1'000'000'000 + nanosec);
}

/// Numbers of one value, more than a few.
bool is_uniform(const Json& array) {
  constexpr std::size_t kFew = 4;
  if (!array.is_array() || array.size() <= kFew || !array.front().is_number()) return false;
  return std::ranges::all_of(array, [&](const Json& element) { return element == array.front(); });
}

/// What is easier to read than the fields; empty where nothing is.
std::string short_text(const Json& value, Detail detail) {
  if (detail == Detail::kAll) return {};
  if (is_time(value)) return time_text(value);
  return is_uniform(value) ? fmt::format("[{} x {}]", value.size(), value_text(value.front(), Detail::kAll)) : "";
}

bool holds_messages(const Json& array) {
  return !array.empty() && array.front().is_object();
}

/// An array of which only the beginning was kept.
bool is_cut(const Json& value) {
  return value.is_object() && value.size() == 2 && value.contains("count") && value.contains("first") &&
         value["first"].is_array();
}

void append(std::string& text, const Json& value, std::size_t indent, Detail detail);

void append_elements(std::string& text, const Json& array, std::size_t indent, Detail detail) {
  for (const Json& element : array) {
    std::string part;
    append(part, element, indent + 2, detail);
    if (part.size() > indent) part[indent] = '-';
    text += part;
  }
}

void append_field(std::string& text, const std::string& name, const Json& value, std::size_t indent, Detail detail) {
  const std::string margin(indent, ' ');
  const bool cut = is_cut(value);
  const Json& shown = cut ? value["first"] : value;
  if (cut) detail = Detail::kAll;
  if (const std::string brief = short_text(shown, detail); !brief.empty()) {
    text += margin + name + ": " + brief + '\n';
  } else if (shown.is_array() && !holds_messages(shown)) {
    text += margin + name + ": [";
    for (std::size_t i = 0; i < shown.size(); ++i) text += (i == 0 ? "" : ", ") + value_text(shown[i], detail);
    text +=
        cut ? fmt::format("{}... {} values]\n", shown.empty() ? "" : ", ", value["count"].get<std::size_t>()) : "]\n";
  } else if (shown.is_array()) {
    text += fmt::format("{}{}:{}\n", margin, name,
                        cut ? fmt::format("  # the first of {}", value["count"].get<std::size_t>()) : "");
    append_elements(text, shown, indent, detail);
  } else if (shown.is_object()) {
    text += margin + name + ":\n";
    append(text, shown, indent + 2, detail);
  } else {
    text += margin + name + ": " + value_text(shown, detail) + '\n';
  }
}

void append(std::string& text, const Json& value, std::size_t indent, Detail detail) {
  if (const std::string brief = short_text(value, detail); !brief.empty()) {
    text += std::string(indent, ' ') + brief + '\n';
    return;
  }
  for (const auto& [name, field] : value.items()) append_field(text, name, field, indent, detail);
}

using bus::RawQos;
using service::bytes_text;

bool latched(const bus::TopicWriter& writer) {
  return writer.qos.durability != RawQos::Durability::kVolatile;
}

/// "reliable", "best effort, latched", or "mixed" where writers differ.
std::string qos_text(const TopicRow& row) {
  const auto text = [](const bus::TopicWriter& writer) {
    return std::string(writer.qos.reliable ? "reliable" : "best effort") + (latched(writer) ? ", latched" : "");
  };
  const std::string first = text(row.writers.front());
  return std::ranges::all_of(row.writers, [&](const auto& w) { return text(w) == first; }) ? first : "mixed";
}

struct Widths {
  std::size_t topic = 5, type = 4;
  explicit Widths(const std::vector<TopicRow>& rows) {
    for (const TopicRow& row : rows) {
      topic = std::max(topic, ros2::ros_topic(row.topic.name).size());
      type = std::max(type, ros2::ros_type(row.topic.type).size());
    }
  }
};

/// At the measured rate.
std::string per_second(const Rate& rate) {
  if (rate.messages < 2) return "-";
  return bytes_text(
      static_cast<std::uint64_t>(rate.hz * static_cast<double>(rate.bytes) / static_cast<double>(rate.messages)));
}

Json names_json(const TopicRow& row) {
  return {{"topic", ros2::ros_topic(row.topic.name)},
          {"dds_topic", row.topic.name},
          {"type", ros2::ros_type(row.topic.type)},
          {"dds_type", row.topic.type}};
}

Json writer_json(const bus::TopicWriter& writer) {
  const auto time = [](std::int64_t ns) { return ns == bus::kUnlimitedNs ? Json() : Json(ns); };
  const std::string hash = ros2::hash_in(writer.user_data);
  return {{"id", bus::to_string(writer.id)},
          {"reliable", writer.qos.reliable},
          {"latched", latched(writer)},
          {"deadline_ns", time(writer.qos.deadline_ns)},
          {"lifespan_ns", time(writer.qos.lifespan_ns)},
          {"liveliness_lease_ns", time(writer.qos.liveliness_lease_ns)},
          {"shared_memory", writer.shared_memory},
          {"type_hash", hash.empty() ? Json() : Json(hash)}};
}

}  // namespace

std::string message_text(const Json& message, Detail detail) {
  std::string text;
  append(text, message, 0, detail);
  return text + "---\n";
}

void RateMeter::add(std::int64_t received_ns, std::size_t bytes) {
  bytes_ += bytes;
  if (messages_++ > 0) {
    const std::int64_t period_ns = std::max<std::int64_t>(0, received_ns - last_ns_);  // two writers may overtake
    const auto periods = static_cast<double>(messages_ - 1);
    const double from_mean = static_cast<double>(period_ns) - mean_ns_;
    mean_ns_ += from_mean / periods;
    squares_ns2_ += from_mean * (static_cast<double>(period_ns) - mean_ns_);
    shortest_ns_ = messages_ == 2 ? period_ns : std::min(shortest_ns_, period_ns);
    longest_ns_ = std::max(longest_ns_, period_ns);
  }
  last_ns_ = received_ns;
}

Rate RateMeter::rate() const {
  Rate rate{messages_, bytes_, lost_};
  if (messages_ < 2) return rate;
  const auto periods = static_cast<double>(messages_ - 1);
  rate.hz = mean_ns_ > 0 ? 1e9 / mean_ns_ : 0;
  rate.mean_ms = mean_ns_ * 1e-6;
  rate.deviation_ms = std::sqrt(squares_ns2_ / periods) * 1e-6;
  rate.shortest_ms = static_cast<double>(shortest_ns_) * 1e-6;
  rate.longest_ms = static_cast<double>(longest_ns_) * 1e-6;
  return rate;
}

std::vector<TopicRow> rows_of(const std::vector<bus::TopicWriter>& writers) {
  std::map<std::pair<std::string, std::string>, TopicRow> rows;
  for (const bus::TopicWriter& writer : writers) {
    TopicRow& row = rows[{ros2::ros_topic(writer.topic.name), writer.topic.type}];
    row.topic = writer.topic;
    row.writers.push_back(writer);
  }
  std::vector<TopicRow> sorted;
  for (auto& [name, row] : rows) sorted.push_back(std::move(row));
  return sorted;
}

std::string list_text(const std::vector<TopicRow>& rows) {
  const Widths width(rows);
  std::string text = fmt::format("{:<{}}  {:<{}}  writers  offers\n", "topic", width.topic, "type", width.type);
  bool unknown = false;
  for (const TopicRow& row : rows) {
    const bool known = ros2::can_read(row.topic.type);
    unknown = unknown || !known;
    text +=
        fmt::format("{:<{}}  {:<{}}  {:>7}  {}{}\n", ros2::ros_topic(row.topic.name), width.topic,
                    ros2::ros_type(row.topic.type), width.type, row.writers.size(), qos_text(row), known ? "" : "  *");
  }
  return text + (unknown ? "* a type that `rtd topics echo` cannot read\n" : "");
}

Json list_json(const std::vector<TopicRow>& rows) {
  Json list = Json::array();
  for (const TopicRow& row : rows) {
    Json one = names_json(row);
    one["readable"] = ros2::can_read(row.topic.type);
    one["writers"] = Json::array();
    for (const bus::TopicWriter& writer : row.writers) one["writers"].push_back(writer_json(writer));
    list.push_back(std::move(one));
  }
  return list;
}

std::string rate_text(const std::vector<TopicRow>& rows, double seconds) {
  const Widths width(rows);
  constexpr const char* kRow = "{:<{}}  {:>8}  {:>7}  {:>7}  {:>7}  {:>8}  {:>4}  {:>8}  {:>8}\n";
  std::string text = fmt::format(fmt::runtime(kRow), "topic", width.topic, "rate Hz", "+- ms", "min ms", "max ms",
                                 "messages", "lost", "size", "per s");
  for (const TopicRow& row : rows) {
    const Rate& rate = row.rate;
    const auto number = [&](double value) {
      return rate.messages < 2 ? std::string("-") : fmt::format("{:.2f}", value);
    };
    text += fmt::format(fmt::runtime(kRow), ros2::ros_topic(row.topic.name), width.topic, number(rate.hz),
                        number(rate.deviation_ms), number(rate.shortest_ms), number(rate.longest_ms), rate.messages,
                        rate.lost, rate.messages > 0 ? bytes_text(rate.bytes / rate.messages) : "-", per_second(rate));
  }
  return text + fmt::format("over {:.1f} s\n", seconds);
}

Json rate_json(const std::vector<TopicRow>& rows, double seconds) {
  Json list = Json::array();
  for (const TopicRow& row : rows) {
    const Rate& rate = row.rate;
    Json one = names_json(row);
    one.update(Json{{"messages", rate.messages},
                    {"lost", rate.lost},
                    {"bytes", rate.bytes},
                    {"rate_hz", rate.hz},
                    {"mean_ms", rate.mean_ms},
                    {"deviation_ms", rate.deviation_ms},
                    {"min_ms", rate.shortest_ms},
                    {"max_ms", rate.longest_ms}});
    list.push_back(std::move(one));
  }
  return {{"seconds", seconds}, {"topics", std::move(list)}};
}

}  // namespace rtd::topics
