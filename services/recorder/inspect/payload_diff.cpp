// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/payload_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/bus/message_types.hpp"
#include "common/ros2/message_json.hpp"
#include "common/ros2/names.hpp"
#include "common/service/json_text.hpp"

namespace rtd::recordings {
namespace {

using Json = nlohmann::ordered_json;

bool is_of_the_run(const std::string& own_type, std::string_view field) {
  return own_type.starts_with("rtd_msgs/") &&
         (field == "published_ns" || field == "finished_ns" || field == "source_id" || field == "stage_ms");
}

/// The payload of a plain message is its memory.
template <class T>
std::vector<ByteRange> run_ranges_of(const std::string& type) {
  constexpr std::size_t kHeaderBytes = 4;
  std::vector<ByteRange> ranges;
  const auto message = std::make_unique<T>();
  msg::for_each_field(*message, [&](const char* name, const auto& field) {
    if (!is_of_the_run(type, name)) return;
    const auto offset = reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(message.get());
    const std::size_t begin = kHeaderBytes + static_cast<std::size_t>(offset);
    ranges.push_back({begin, begin + sizeof(field)});
  });
  return ranges;
}

template <class... T>
std::map<std::string, std::vector<ByteRange>> all_run_ranges(bus::TypeList<T...>) {
  std::map<std::string, std::vector<ByteRange>> all;
  const auto add = [&]<class Message>() {
    const std::string type = msg::type_name(msg::TypeOf<Message>());
    if constexpr (bus::MessageTraits<Message>::kPlain) all[type] = run_ranges_of<Message>(type);
  };
  (add.template operator()<T>(), ...);
  return all;
}

/// Two messages of one type, field by field.
class Comparison {
 public:
  explicit Comparison(std::string type) : type_(std::move(type)) {}

  /// `name` is the path of the field, `place` which elements of arrays it is in.
  void compare(const Json& a, const Json& b, const std::string& name, const std::string& place) {
    if (a == b) return;
    if (a.is_object()) {
      for (const auto& [field, value] : a.items()) {
        compare(value, b.at(field), name.empty() ? field : name + '.' + field, place);
      }
    } else if (a.is_array()) {
      if (a.size() != b.size()) add(name, place, fmt::format("{} | {} elements", a.size(), b.size()));
      for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        if (a[i] != b[i]) compare(a[i], b[i], name, place + '[' + std::to_string(i) + ']');
      }
    } else {
      add(name, place, text_of(a) + " | " + text_of(b));
    }
  }

  std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    for (const Field& field : fields_) {
      const std::string values = field.values > 1 ? fmt::format(": {} values, first", field.values) : ":";
      lines.push_back(field.name + values + field.first + (is_of_the_run(type_, field.name) ? " (of the run)" : ""));
    }
    return lines;
  }

 private:
  struct Field {
    std::string name, first;
    std::size_t values = 0;
  };

  void add(const std::string& name, const std::string& place, const std::string& values) {
    auto field = std::ranges::find(fields_, name, &Field::name);
    if (field == fields_.end()) field = fields_.insert(field, {name, place + ' ' + values, 0});
    ++field->values;
  }

  static std::string text_of(const Json& value) {
    if (value.is_number_float()) return fmt::format("{}", value.get<double>());
    return service::json_line(value);
  }

  const std::string type_;
  std::vector<Field> fields_;
};

std::vector<std::string> first_byte(io::ByteView a, io::ByteView b) {
  std::vector<std::string> lines;
  if (a.size() != b.size())
    lines.push_back("size: " + std::to_string(a.size()) + " | " + std::to_string(b.size()) + " bytes");
  const auto at = std::ranges::mismatch(a, b);
  if (at.in1 != a.end() && at.in2 != b.end())
    lines.push_back("first at byte " + std::to_string(at.in1 - a.begin()) + " of the payload");
  return lines;
}

}  // namespace

std::vector<ByteRange> run_ranges(const std::string& type) {
  static const auto kRanges = all_run_ranges(bus::MessageTypes());
  const auto known = kRanges.find(ros2::short_type(type));
  return known == kRanges.end() ? std::vector<ByteRange>() : known->second;
}

std::vector<std::string> differences(const std::string& type, io::ByteView a, io::ByteView b) {
  const std::string dds_type = ros2::dds_type(type);
  if (!ros2::can_read(dds_type)) return first_byte(a, b);
  const auto read = [&](io::ByteView payload) {
    return ros2::message_json(dds_type, {reinterpret_cast<const std::uint8_t*>(payload.data()), payload.size()}, 0);
  };
  try {
    Comparison comparison(ros2::short_type(dds_type));
    comparison.compare(read(a), read(b), "", "");
    const std::vector<std::string> lines = comparison.lines();
    return lines.empty() ? first_byte(a, b) : lines;
  } catch (const ros::WireError&) {
    return {"one of them is too short for its type"};
  }
}

}  // namespace rtd::recordings
