// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/copy_recording.hpp"

#include <optional>
#include <set>
#include <utility>

#include "common/io/atomic_file.hpp"
#include "common/io/byte_sink.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/writer.hpp"
#include "common/recordings/reader.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/ros1_to_cdr.hpp"
#include "common/ros2/type_description.hpp"

namespace rtd::recordings {
namespace {

constexpr std::size_t kMaxDamages = 100;

/// What becomes of the messages of a channel.
struct Output {
  mcap::ChannelId id = 0;
  std::optional<ros2::Ros1ToCdr> to_cdr;  ///< empty: as they are
  recorder::BlurTopic topic;
};

ros::Bytes bytes_of(std::span<const std::byte> data) {
  return {reinterpret_cast<const std::uint8_t*>(data.data()), data.size()};
}

recorder::BlurTopic blur_topic(const mcap::Channel& channel, const std::string& type) {
  return {ros2::dds_topic(channel.topic), plain_type(type)};
}

/// ROS 1's older name of what ROS 2 calls tf2_msgs/msg/TFMessage.
std::string ros2_name(const std::string& type) {
  if (type == "tf/tfMessage") return "tf2_msgs/msg/TFMessage";
  const std::size_t slash = type.find('/');
  return slash == std::string::npos || type.find("/msg/") != std::string::npos
             ? type
             : type.substr(0, slash) + "/msg" + type.substr(slash);
}

class Copy {
 public:
  Copy(const io::ByteSource& source, io::ByteSink& sink, mcap::Compression compression, recorder::PeopleBlur* people,
       CopiedRecording& result)
      : reader_(source),
        writer_(sink, {.profile = "ros2", .compression = compression}),
        people_(people),
        result_(result) {}

  void run(const std::function<void(std::uint64_t)>& progress) {
    mcap::MessageCursor cursor = reader_.messages();
    while (const mcap::Message* const message = cursor.next()) {
      if (const Output* const output = output_of(cursor.channel())) copy(*message, *output, cursor.channel().topic);
      progress(bytes_ += message->data.size());
    }
    copy_rest();
    writer_.close();
    result_.topics = topics_.size();
    for (const mcap::Problem& problem : reader_.problems().listed()) {
      if (mcap::is_damage(problem)) note(mcap::to_string(problem));
    }
  }

 private:
  void copy(const mcap::Message& message, const Output& output, const std::string& topic) {
    try {
      mcap::Message copy = message;
      copy.channel_id = output.id;
      std::vector<std::uint8_t> cdr;
      if (output.to_cdr) {
        cdr = (*output.to_cdr)(bytes_of(message.data));
        copy.data = std::as_bytes(std::span(cdr));
        ++result_.from_ros1;
      }
      const recorder::PeopleBlur::Result blurred =
          people_ == nullptr ? recorder::PeopleBlur::Result{} : people_->apply(output.topic, bytes_of(copy.data));
      if (blurred.fate == recorder::Fate::kWithheld) return;
      if (blurred.fate != recorder::Fate::kKept) copy.data = std::as_bytes(std::span(blurred.cdr));
      writer_.write(copy);
      ++result_.messages;
      topics_.insert(topic);
    } catch (const ros::WireError& error) {
      note("a message of " + topic + " is left out: " + error.what());
    }
  }

  /// Null for a channel that is left out.
  const Output* output_of(const mcap::Channel& channel) {
    const auto [known, first] = outputs_.try_emplace(channel.id);
    if (first) known->second = make_output(channel);
    return known->second ? &*known->second : nullptr;
  }
  std::optional<Output> make_output(const mcap::Channel& channel) {
    try {
      const auto found = reader_.summary().schemas.find(channel.schema_id);
      mcap::Schema schema = found == reader_.summary().schemas.end() ? mcap::Schema{} : found->second;
      mcap::Channel copy = channel;
      std::optional<ros2::Ros1ToCdr> to_cdr;
      if (channel.message_encoding == "ros1") {
        to_cdr = from_ros1(schema);
        copy.message_encoding = "cdr";
        copy.metadata.erase("md5sum");
      } else if (schema.data.empty()) {
        describe(schema);
      }
      copy.schema_id = schema.name.empty() ? mcap::SchemaId{0} : writer_.add(schema);
      return Output{writer_.add(std::move(copy)), std::move(to_cdr), blur_topic(channel, schema.name)};
    } catch (const ros::DefinitionError& error) {
      result_.left_out[channel.topic] = error.what();
      return std::nullopt;
    }
  }
  static ros2::Ros1ToCdr from_ros1(mcap::Schema& schema) {
    const std::string type = schema.name;
    ros::MessageFields types = ros::parse_definition(type, schema.data);
    const std::string text = ros2::ros2msg_text(type, ros2::as_ros2(types));
    schema = {0, ros2_name(type), "ros2msg", text};
    return {type, std::move(types)};
  }
  /// Older databases have no definitions: those of the types that are known here.
  static void describe(mcap::Schema& schema) {
    const ros2::TypeDefinition definition = ros2::definition_of(ros2::dds_type(schema.name));
    if (definition.known()) schema = {0, definition.name, definition.encoding, definition.text};
  }
  void copy_rest() {
    for (const mcap::AttachmentIndex& index : reader_.summary().attachment_indexes) {
      if (const auto attachment = reader_.attachment(index)) writer_.write(*attachment);
    }
    for (const mcap::MetadataIndex& index : reader_.summary().metadata_indexes) {
      if (const auto metadata = reader_.metadata(index)) writer_.write(*metadata);
    }
  }
  void note(const std::string& damage) {
    if (result_.damages.size() < kMaxDamages) result_.damages.push_back(damage);
  }

  mcap::IndexedReader reader_;
  mcap::Writer writer_;
  recorder::PeopleBlur* const people_;
  CopiedRecording& result_;
  std::map<mcap::ChannelId, std::optional<Output>> outputs_;
  std::set<std::string> topics_;
  std::uint64_t bytes_ = 0;
};

}  // namespace

CopiedRecording copy_recording(const Opened& source, const std::filesystem::path& file, mcap::Compression compression,
                               recorder::PeopleBlur* people, const std::function<void(std::uint64_t)>& progress) {
  io::AtomicFile sink(file, {.named_by = io::NamedBy::kOperator, .if_exists = io::IfExists::kFail});
  CopiedRecording result;
  result.damages = source.damages;
  Copy(*source.source, sink, compression, people, result).run(progress);
  if (people != nullptr) result.people = people->counts();
  sink.commit();
  return result;
}

recorder::PeopleBlur people_in(const Opened& source) {
  recorder::PeopleBlur people;
  mcap::IndexedReader reader(*source.source);
  mcap::MessageCursor cursor = reader.messages();
  while (const mcap::Message* const message = cursor.next()) {
    const auto schema = reader.summary().schemas.find(cursor.channel().schema_id);
    if (schema == reader.summary().schemas.end() || cursor.channel().message_encoding != "cdr") continue;
    people.learn(blur_topic(cursor.channel(), schema->second.name), bytes_of(message->data));
  }
  return people;
}

}  // namespace rtd::recordings
