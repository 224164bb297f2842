// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/recording_echo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <ostream>

#include "common/io/recording_forms.hpp"
#include "common/recordings/parts.hpp"
#include "common/recordings/reader.hpp"
#include "common/ros2/message_json.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/message_definition.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "services/topics/core/topic_report.hpp"

namespace rtd::topics {
namespace {

namespace fs = std::filesystem;
using recordings::RecordedMessage;
using recordings::RecordedTopic;

constexpr std::size_t kShownErrors = 5;

/// How the messages of a recorded topic are read.
struct RecordedType {
  std::string type;           ///< "package/Type"
  ros::MessageFields fields;  ///< of the type and all that it is made of
  std::string problem;        ///< why they cannot be read; empty when they can
};

using Types = std::map<std::string, RecordedType>;  ///< by topic

/// The text of IDL defines the same samples as ours, or does not define the type.
bool same_layout(const RecordedTopic& topic) {
  const std::string name = topic.type.substr(topic.type.find('/') + 1) + '_';
  const std::string recorded = ros2::layout_in(topic.schema_text, name);
  const std::string ours = ros2::layout_in(ros2::own_idl(), name);
  return recorded.empty() || ours.empty() || recorded == ours;
}

void take_known(RecordedType& type, const RecordedTopic& topic) {
  if (ros2::fields_of(topic.type) == nullptr) {
    type.problem =
        topic.schema_text.empty()
            ? "the recording does not define " + topic.type + ", and it is not known here"
            : topic.type + " is defined as " + topic.schema_encoding + ", which is not read, and it is not known here";
  } else if (!same_layout(topic)) {
    type.problem = topic.type + " was recorded by another version, with other fields";
  } else {
    type.fields = ros2::message_fields();
  }
}

/// By the definition in the recording (ros1msg, ros2msg); without one, or with one in IDL, by the types that are known
/// here. A type of our own must have the layout that it has in the recording.
RecordedType type_of(const RecordedTopic& topic) {
  RecordedType type{ros::package_and_type(topic.type), {}, {}};
  const bool defined = topic.schema_encoding == "ros1msg" || topic.schema_encoding == "ros2msg";
  if (!defined || topic.schema_text.empty()) {
    take_known(type, topic);
    return type;
  }
  try {
    type.fields = ros::parse_definition(type.type, topic.schema_text);
  } catch (const ros::DefinitionError& error) {
    type.problem = error.what();
  }
  return type;
}

Types types_of(const recordings::Reader& recording) {
  Types types;
  for (const RecordedTopic& topic : recording.topics()) types.try_emplace(topic.name, type_of(topic));
  return types;
}

/// Prints messages of several topics.
class RecordingPrinter {
 public:
  RecordingPrinter(const TopicsRequest& request, const Types& types, std::ostream& out, std::ostream& err)
      : request_(request), types_(types), out_(out), err_(err) {}

  void print(const RecordedMessage& message) {
    try {
      const RecordedType& type = types_.at(message.topic);
      const auto json = ros2::message_json(type.fields, type.type, message.wire, message.bytes, request_.max_array);
      if (request_.json) {
        const nlohmann::ordered_json line{{"topic", ros2::ros_topic(message.topic)},
                                          {"type", type.type},
                                          {"recorded_ns", message.recorded_ns},
                                          {"message", json}};
        out_ << service::json_line(line) << '\n';
      } else {
        if (request_.topics.size() != 2) out_ << title_of(message, type);
        out_ << message_text(json, request_.verbose ? Detail::kAll : Detail::kReadable);
      }
      ++printed_;
    } catch (const ros::WireError& error) {
      if (++unreadable_ > kShownErrors) return;
      err_ << fmt::format("rtd topics: the message of {} recorded at {} ns is not a {}: {}\n",
                          ros2::ros_topic(message.topic), message.recorded_ns, types_.at(message.topic).type,
                          error.what());
    }
  }
  std::uint64_t printed() const { return printed_; }
  std::uint64_t unreadable() const { return unreadable_; }

 private:
  static std::string title_of(const RecordedMessage& message, const RecordedType& type) {
    return fmt::format("# {} {} at {}.{:09d} s\n", ros2::ros_topic(message.topic), type.type,
                       message.recorded_ns / 1'000'000'000,
                       std::max<std::int64_t>(0, message.recorded_ns % 1'000'000'000));
  }

  const TopicsRequest& request_;
  const Types& types_;
  std::ostream &out_, &err_;
  std::uint64_t printed_ = 0, unreadable_ = 0;
};

std::string readable_topics(const Types& types) {
  std::vector<std::string> names;
  for (const auto& [name, type] : types) {
    if (type.problem.empty()) names.push_back(ros2::ros_topic(name));
  }
  return names.empty() ? "no topic of the recording can be printed"
                       : fmt::format("topics that can be printed: {}", fmt::join(names, ", "));
}

/// The topics to print by their names in the recording; empty when one named is not there or cannot be read.
std::vector<std::string> named_topics(const TopicsRequest& request, const Types& types, std::ostream& err) {
  std::vector<std::string> chosen;
  for (std::size_t i = 1; i < request.topics.size(); ++i) {
    const std::string& wanted = request.topics[i];
    const auto found = std::ranges::find_if(
        types, [&](const auto& one) { return one.first == wanted || ros2::ros_topic(one.first) == wanted; });
    if (found == types.end() || !found->second.problem.empty()) {
      const std::string cause = found == types.end() ? "has no topic " + wanted
                                                     : ": " + wanted + " cannot be printed: " + found->second.problem;
      err << fmt::format("rtd topics: {}{}{}; {}\n", request.topics.front(), found == types.end() ? " " : "", cause,
                         readable_topics(types));
      return {};
    }
    chosen.push_back(found->first);
  }
  return chosen;
}

/// All that can be read; names the others.
std::vector<std::string> all_topics(const Types& types, std::ostream& err) {
  std::vector<std::string> chosen;
  for (const auto& [name, type] : types) {
    if (type.problem.empty()) {
      chosen.push_back(name);
    } else {
      err << fmt::format("rtd topics: {} is left out: {}\n", ros2::ros_topic(name), type.problem);
    }
  }
  if (chosen.empty()) err << "rtd topics: " << readable_topics(types) << '\n';
  return chosen;
}

void print_all(const TopicsRequest& request, recordings::Reader& recording, RecordingPrinter& printer,
               const std::ostream& out) {
  const std::uint64_t most = request.once ? 1 : request.count;
  std::optional<std::int64_t> first_ns;
  while (out && (most == 0 || printer.printed() < most)) {
    const std::optional<RecordedMessage> message = recording.next();
    if (!message) return;
    if (!first_ns) first_ns = message->recorded_ns;
    const double seconds = static_cast<double>(message->recorded_ns - *first_ns) * 1e-9;
    if (request.duration_s > 0 && seconds > request.duration_s) return;
    printer.print(*message);
  }
}

}  // namespace

bool is_recording(const std::string& argument) {
  std::error_code none;
  if (fs::is_regular_file(argument, none) || io::is_recording_name(argument)) return true;
  return fs::is_directory(argument, none) && recordings::holds_recording(argument);
}

int echo_recording(const TopicsRequest& request, std::ostream& out, std::ostream& err) {
  const std::unique_ptr<recordings::Reader> recording = recordings::open_reader(request.topics.front());
  const Types types = types_of(*recording);
  const std::vector<std::string> chosen =
      request.topics.size() > 1 ? named_topics(request, types, err) : all_topics(types, err);
  if (chosen.empty()) return service::kUsageOrConfig;
  recording->play(chosen);
  RecordingPrinter printer(request, types, out, err);
  print_all(request, *recording, printer, out);
  const std::vector<std::string> damages = recording->take_damages();
  for (const std::string& damage : damages) err << "rtd topics: " << damage << '\n';
  if (printer.unreadable() > kShownErrors)
    err << fmt::format("rtd topics: {} messages do not match their types\n", printer.unreadable());
  if (!damages.empty() || printer.unreadable() > 0) return service::kPartialLoss;
  if (printer.printed() > 0) return service::kOk;
  err << fmt::format("rtd topics: {} has no message of these topics\n", request.topics.front());
  return service::kRunFailed;
}

}  // namespace rtd::topics
