// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// `rtd topics mirror`: our own topics under names that ROS 2 knows.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <ostream>
#include <set>

#include "common/bus/network.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topic_roles.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/service/exit_code.hpp"
#include "services/topics/topics_command.hpp"
#include "services/topics/topics_session.hpp"

namespace rtd::topics {
namespace {

using namespace std::chrono_literals;

constexpr char kOwn[] = "rtd/";

/// Passes the samples of a topic on as they are, while they are received.
class Mirror {
 public:
  Mirror(bus::RawBus& bus, const bus::TopicWriter& source)
      : bus_(bus),
        source_(source),
        writer_(bus.writer({mirror_name(source.topic.name), source.topic.type}, qos(source))) {}

  static std::string mirror_name(const std::string& topic) { return "rt/" + topic; }

  void follow_demand() {
    if (writer_->matched() == 0) return reader_.reset();
    if (reader_) return;
    bus::RawReaderOptions options;
    options.reliable = source_.qos.reliable;
    options.transient_local = latched(source_);
    options.depth = kReaderDepth;
    bus::RawHandlers handlers;
    handlers.on_sample = [this](const bus::RawSample& sample) { writer_->write(sample.cdr(), sample.source_ns); };
    reader_ = bus_.reader(source_.topic, options, std::move(handlers));
  }

 private:
  static bool latched(const bus::TopicWriter& source) {
    return source.qos.durability != bus::RawQos::Durability::kVolatile;
  }
  /// As our writers of ROS topics: no deadline and no lease, which a usual subscription would not match.
  static bus::RawWriterOptions qos(const bus::TopicWriter& source) {
    bus::RawWriterOptions options;
    options.qos.reliable = source.qos.reliable;
    options.qos.depth = kReaderDepth;
    if (latched(source)) options.qos.durability = bus::RawQos::Durability::kTransientLocal;
    return options;
  }

  bus::RawBus& bus_;
  const bus::TopicWriter source_;
  std::unique_ptr<bus::RawWriter> writer_;
  std::unique_ptr<bus::RawReader> reader_;  // last: it uses the writer
};

/// Topics of the table, of any robot, or those that are named: another program may have any number of others.
bool is_mirrored(const bus::RawTopic& topic, const std::vector<std::string>& named) {
  const std::string& wire_name = topic.name;
  if (!wire_name.starts_with(kOwn) || bus::stays_on_host(wire_name) || wire_name == ros2::kSchemasTopic) return false;
  if (named.empty())
    return std::ranges::count(bus::topic_roles(), bus::split_robot(wire_name).topic, &bus::TopicRoles::topic) > 0;
  const bus::RawTopic mirror{Mirror::mirror_name(wire_name), topic.type};
  return std::ranges::any_of(named, [&](const std::string& name) { return is_called(mirror, name); });
}

}  // namespace

int mirror_topics(const TopicsRequest& request, TopicsSession& session, std::ostream& out) {
  constexpr std::size_t kMostMirrors = 256;  // of 32 robots: another program may have the topics of any number
  std::map<std::string, Mirror> mirrors;
  while (session.continues(100ms)) {
    std::set<std::string> present;
    for (const bus::TopicWriter& writer : session.writers()) {
      const std::string& name = writer.topic.name;
      if (!is_mirrored(writer.topic, request.topics) || !present.insert(name).second) continue;
      if (mirrors.size() >= kMostMirrors) continue;
      if (mirrors.try_emplace(name, session.bus(), writer).second)
        out << fmt::format("{} as {}\n", name, ros2::ros_topic(Mirror::mirror_name(name))) << std::flush;
    }
    std::erase_if(mirrors, [&](const auto& mirror) { return !present.contains(mirror.first); });
    for (auto& [name, mirror] : mirrors) mirror.follow_demand();
  }
  return service::kOk;
}

}  // namespace rtd::topics
