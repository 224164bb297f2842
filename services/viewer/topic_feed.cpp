// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/topic_feed.hpp"

#include <algorithm>
#include <cctype>

#include "common/bus/robot.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/log.hpp"

namespace rtd::viewer {
namespace {

constexpr int kDepth = 16;
constexpr std::size_t kMaxPublished = 64;

std::shared_ptr<const Bytes> copy_of(std::span<const std::byte> bytes) {
  return std::make_shared<const Bytes>(bytes.begin(), bytes.end());
}

/// The types of the bus with field names as ROS 2 allows them: all lower-case ("t_world_camera").
const ros2::MessageFields& ros_fields() {
  static const ros2::MessageFields kFields = [] {
    ros2::MessageFields fields = ros2::message_fields();
    for (auto& [type, members] : fields)
      for (ros2::MessageField& member : members)
        std::ranges::transform(member.name, member.name.begin(),
                               [](unsigned char letter) { return std::tolower(letter); });
    return fields;
  }();
  return kFields;
}

/// What a graph shows of the connections: their names, and where several have the same one also an id.
class ParticipantNames {
 public:
  explicit ParticipantNames(std::map<bus::ParticipantId, std::string> names) : names_(std::move(names)) {
    for (const auto& [id, name] : names_) ++uses_[name];
  }
  std::string of(const bus::WriterId& endpoint) const {
    const bus::ParticipantId id = bus::participant_of(endpoint);
    const auto known = names_.find(id);
    if (known == names_.end()) return bus::to_string(endpoint).substr(0, 2 * id.size());
    return uses_.at(known->second) == 1 ? known->second
                                        : known->second + ' ' + bus::to_string(endpoint).substr(0, 2 * id.size());
  }

 private:
  const std::map<bus::ParticipantId, std::string> names_;
  std::map<std::string, int> uses_;
};

/// One connection may have several endpoints of a topic.
void add_name(std::vector<std::string>& names, std::string name) {
  if (std::ranges::count(names, name) == 0) names.push_back(std::move(name));
}

}  // namespace

TopicFeed::TopicFeed(bus::RawBus& bus, FoxgloveHub& hub, Dispatcher dispatcher, std::vector<std::string> patterns,
                     std::function<void()> robots_changed)
    : bus_(bus),
      hub_(hub),
      dispatcher_(std::move(dispatcher)),
      patterns_(std::move(patterns)),
      robots_changed_(std::move(robots_changed)),
      follower_(bus, {.handlers = [this](const bus::RawTopic& topic) { return handlers(entries_.at(topic.name)); },
                      .on_writer = [this](const bus::TopicWriter& writer) { add(writer); },
                      .on_gone = [this](const bus::RawTopic& topic) { remove(topic.name); },
                      .on_refused =
                          [](const bus::TopicWriter& writer, const bus::BusError& error) {
                            SPDLOG_WARN("event=not_read topic={} cause=\"{}\"", writer.topic.name, error.what());
                          },
                      .run = [this](std::function<void()> change) { dispatcher_.order(std::move(change)); },
                      .on_demand = true,
                      .reader = {.transient_local = true, .depth = kDepth}}) {}

void TopicFeed::stop() {
  if (std::exchange(stopped_, true)) return;
  follower_.stop();
  schema_reader_.reset();
  published_.clear();
}

bool TopicFeed::allowed(const std::string& topic) const {
  return std::ranges::any_of(patterns_,
                             [&](const std::string& pattern) { return ros2::matches_topic(pattern, topic); });
}

void TopicFeed::add(const bus::TopicWriter& writer) {
  if (writer.topic.name == ros2::kSchemasTopic) learn_types(writer);
  Entry& entry = entries_[writer.topic.name];
  entry.topic = writer.topic;
  if (entry.channel == 0 && allowed(entry.topic.name) && !bus::is_internal_to_ros(entry.topic.name))
    entry.channel = hub_.add_channel(ros2::ros_topic(entry.topic.name), schema_of(entry.topic.type));
  robots_changed_();
}

void TopicFeed::remove(const std::string& topic) {
  const std::uint32_t channel = entries_.at(topic).channel;
  if (channel != 0) hub_.remove_channel(channel);  // want() is called when it was wanted
  entries_.erase(topic);
  robots_changed_();
}

foxglove::Schema TopicFeed::schema_of(const std::string& dds_type) const {
  const std::string ros_type = ros2::ros_type(dds_type), name = ros2::short_type(dds_type);
  if (!name.empty() && ros2::fields_of(name) != nullptr)
    return {"cdr", ros_type, "ros2msg", ros2::ros2msg_text(name, ros_fields())};
  const auto learned = learned_.find(dds_type);
  if (learned == learned_.end()) return {"cdr", ros_type, "", ""};
  return {"cdr", learned->second.name, learned->second.encoding, learned->second.text};
}

/// A replay knows the texts of the types that it plays.
void TopicFeed::learn_types(const bus::TopicWriter& writer) {
  if (schema_reader_ || writer.topic.type != ros2::kSchemasType) return;
  try {
    bus::RawHandlers handlers;
    handlers.on_sample = [this](const bus::RawSample& sample) { dispatcher_.order([this, sample] { learn(sample); }); };
    schema_reader_ = bus_.reader(writer.topic, {.reliable = true, .transient_local = true}, std::move(handlers));
  } catch (const bus::BusError& error) {
    SPDLOG_WARN("event=schemas_not_read topic={} cause=\"{}\"", writer.topic.name, error.what());
  }
}

void TopicFeed::learn(const bus::RawSample& sample) {
  if (stopped_) return;
  try {
    for (const auto& [dds_type, definition] : ros2::decode_schemas(sample.cdr()))
      learned_.insert_or_assign(dds_type, definition);
  } catch (const ros::WireError& error) {
    SPDLOG_WARN("event=schemas_not_read topic={} cause=\"{}\"", ros2::kSchemasTopic, error.what());
    return;
  }
  for (auto& [name, entry] : entries_) {  // offered again, with a text
    if (entry.channel == 0 || !learned_.contains(entry.topic.type)) continue;
    hub_.remove_channel(entry.channel);
    entry.channel = hub_.add_channel(ros2::ros_topic(name), schema_of(entry.topic.type));
  }
}

void TopicFeed::want(std::uint32_t channel, bool wanted) {
  for (const auto& [name, entry] : entries_) {
    if (entry.channel == channel) follower_.read(name, wanted);
  }
}

bus::RawHandlers TopicFeed::handlers(const Entry& entry) {
  bus::RawHandlers handlers;
  handlers.on_sample = [this, channel = entry.channel](const bus::RawSample& sample) {
    dispatcher_.deliver(
        [this, channel, sample] {
          if (hub_.wanted(channel)) hub_.publish(channel, sample.source_ns, copy_of(sample.cdr()));
        },
        sample.cdr().size());
  };
  return handlers;
}

void TopicFeed::update_graph() {
  const ParticipantNames names(bus_.participants());
  foxglove::ConnectionGraph graph;
  for (const bus::TopicWriter& writer : bus_.writers()) {
    const std::string& topic = writer.topic.name;
    if (const std::string service(bus::service_of_reply(topic)); !service.empty()) {
      add_name(graph.services['/' + service], names.of(writer.id));
    } else if (!bus::is_internal_to_ros(topic)) {
      add_name(graph.published[ros2::ros_topic(topic)], names.of(writer.id));
    }
  }
  for (const bus::TopicReader& reader : bus_.readers()) {
    if (!bus::is_internal_to_ros(reader.topic.name))
      add_name(graph.subscribed[ros2::ros_topic(reader.topic.name)], names.of(reader.id));
  }
  hub_.set_graph(std::move(graph));
}

std::string TopicFeed::publish(const std::string& topic, const std::string& type, std::span<const std::byte> cdr) {
  constexpr std::size_t kCdrHeader = 4;
  if (cdr.size() < kCdrHeader) return "a message has no CDR header";
  auto& writer = published_[topic];
  try {
    if (!writer) {
      if (published_.size() > kMaxPublished) throw bus::BusError("too many topics are published");
      writer = bus_.writer({ros2::dds_topic(topic), ros2::dds_type(type)}, {.qos = {.depth = 10}});
    }
    return writer->write(cdr) ? "" : "topic '" + topic + "' did not take the message";
  } catch (const bus::BusError& error) {
    published_.erase(topic);
    return "topic '" + topic + "': " + error.what();
  }
}

}  // namespace rtd::viewer
