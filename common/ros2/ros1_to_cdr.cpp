// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/ros1_to_cdr.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

namespace rtd::ros2 {
namespace {

using Kind = ros::MessageField::Kind;

constexpr const char *kHeader = "std_msgs/Header", *kTime = "builtin_interfaces/Time",
                     *kDuration = "builtin_interfaces/Duration";

/// How a type without fields lies in the message.
struct Numbers {
  std::size_t count, bytes;
};
const std::map<std::string, Numbers> kNumbers = {
    {"bool", {1, 1}},   {"byte", {1, 1}},  {"char", {1, 1}},     {"uint8", {1, 1}},   {"int8", {1, 1}},
    {"uint16", {1, 2}}, {"int16", {1, 2}}, {"uint32", {1, 4}},   {"int32", {1, 4}},   {"uint64", {1, 8}},
    {"int64", {1, 8}},  {"time", {2, 4}},  {"duration", {2, 4}}, {"float32", {1, 4}}, {"float64", {1, 8}}};

std::string lower_snake(const std::string& name) {
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    const bool begins_word =
        std::isupper(c) != 0 && i > 0 && std::islower(static_cast<unsigned char>(name[i - 1])) != 0;
    if (begins_word) text += '_';
    text += static_cast<char>(std::tolower(c));
  }
  return text;
}

class Transcription {
 public:
  Transcription(const ros::MessageFields& types, ros::Bytes ros1)
      : types_(types), in_(ros1), steps_left_(kFreeSteps + kStepsPerByte * ros1.size()) {
    cdr_.reserve(ros1.size() + ros1.size() / 8 + kHeaderBytes);
    cdr_ = {0, 1, 0, 0};
  }
  /// Types can be made of nothing: what they claim must not cost more than the bytes are worth.
  void message(const std::string& type) {
    const std::vector<ros::MessageField>& fields = types_.at(type);
    if (steps_left_ <= fields.size()) throw ros::WireError("the type claims more fields than the message has bytes");
    steps_left_ -= 1 + fields.size();
    for (const ros::MessageField& field : fields) {
      if (field.name == "seq" && type == kHeader) {
        in_.take(sizeof(std::uint32_t));
      } else {
        read(field);
      }
    }
    if (fields.empty()) cdr_.push_back(0);  // in CDR no struct is empty
  }
  std::vector<std::uint8_t> finish() {
    if (in_.remaining() == 0) return std::move(cdr_);
    throw ros::WireError(std::to_string(in_.remaining()) + " bytes are left behind the message");
  }

 private:
  static constexpr std::size_t kHeaderBytes = 4, kFreeSteps = 1'000, kStepsPerByte = 16;

  void read(const ros::MessageField& field) {
    std::size_t count = field.kind == Kind::kArray ? field.capacity : 1;
    if (field.kind == Kind::kSequence) {
      count = in_.read<std::uint32_t>();
      put(static_cast<std::uint32_t>(count));
    }
    const auto number = kNumbers.find(field.type);
    if (number != kNumbers.end()) return numbers(count, number->second);
    if (count > in_.remaining() && count > 1) throw ros::WireError(std::to_string(count) + " elements are claimed");
    for (std::size_t i = 0; i < count; ++i) field.is_message() ? message(field.type) : text();
  }
  void numbers(std::size_t count, const Numbers& each) {
    const std::size_t bytes = each.count * each.bytes;
    if (count > in_.remaining() / bytes) throw ros::WireError(std::to_string(count) + " numbers are claimed");
    if (count == 0) return;
    align(each.bytes);
    const ros::Bytes taken = in_.take(count * bytes);
    cdr_.insert(cdr_.end(), taken.begin(), taken.end());
  }
  void text() {
    const ros::Bytes taken = in_.take(in_.read<std::uint32_t>());
    put(static_cast<std::uint32_t>(taken.size() + 1));
    cdr_.insert(cdr_.end(), taken.begin(), taken.end());
    cdr_.push_back(0);
  }
  void put(std::uint32_t number) {
    align(sizeof number);
    for (unsigned shift = 0; shift < 32; shift += 8) cdr_.push_back(static_cast<std::uint8_t>(number >> shift));
  }
  void align(std::size_t bytes) {
    const std::size_t position = cdr_.size() - kHeaderBytes;
    cdr_.insert(cdr_.end(), (bytes - position % bytes) % bytes, 0);
  }

  const ros::MessageFields& types_;
  ros::ByteCursor in_;
  std::size_t steps_left_;
  std::vector<std::uint8_t> cdr_;
};

}  // namespace

ros::MessageFields as_ros2(ros::MessageFields types) {
  if (const auto header = types.find(kHeader); header != types.end()) {
    std::erase_if(header->second, [](const ros::MessageField& field) { return field.name == "seq"; });
  }
  bool has_time = false, has_duration = false;
  for (auto& [type, fields] : types) {
    for (ros::MessageField& field : fields) {
      has_time = has_time || field.type == "time";
      has_duration = has_duration || field.type == "duration";
      if (field.type == "time") field.type = kTime;
      if (field.type == "duration") field.type = kDuration;
      if (field.type == "char") field.type = "uint8";
      field.name = lower_snake(field.name);
    }
  }
  const std::vector<ros::MessageField> time = {{"int32", "sec", Kind::kOne, 0}, {"uint32", "nanosec", Kind::kOne, 0}};
  if (has_time) types[kTime] = time;
  if (has_duration) types[kDuration] = time;
  return types;
}

Ros1ToCdr::Ros1ToCdr(std::string type, ros::MessageFields types) : type_(std::move(type)), types_(std::move(types)) {
  for (const auto& [name, fields] : types_) {
    for (const ros::MessageField& field : fields) {
      if (field.type == "wstring") throw ros::DefinitionError("the type " + name + " has a wstring, unknown to ROS 1");
    }
  }
}

std::vector<std::uint8_t> Ros1ToCdr::operator()(ros::Bytes ros1) const {
  Transcription transcription(types_, ros1);
  transcription.message(type_);
  return transcription.finish();
}

}  // namespace rtd::ros2
