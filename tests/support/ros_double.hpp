// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/bus/robot.hpp"
#include "common/msg/parameters.hpp"
#include "common/msg/ros_graph.hpp"
#include "common/ros2/names.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/rmw_user_data.hpp"

/// What a program of ROS 2 does beside its own topics, as rcl and the RMWs do it: it collects the nodes that others
/// announce, looks at the USER_DATA of every endpoint, and calls the services of parameters.
namespace rtd::testing {

class RosDouble {
 public:
  using Info = msg::ParticipantEntitiesInfo<16>;

  explicit RosDouble(const bus::BusOptions& options) : bus_(bus::connect_raw(without_node(options))) {
    bus::RawReaderOptions latched;
    latched.transient_local = true;
    bus::RawHandlers handlers;
    handlers.on_sample = [this](const bus::RawSample& sample) { take(sample); };
    reader_ = bus_->reader({std::string(bus::kRosGraphTopic), kGraphType}, latched, std::move(handlers));
  }

  /// `ros2 node list`.
  std::set<std::string> nodes() const {
    const std::lock_guard lock(mutex_);
    std::set<std::string> names;
    for (const auto& [gid, info] : participants_)
      for (const auto& node : info.node_entities_info_seq) names.insert(full_name(node));
    return names;
  }
  /// How often each name is announced: ROS warns of names that are not unique.
  std::map<std::string, int> counted_nodes() const {
    const std::lock_guard lock(mutex_);
    std::map<std::string, int> names;
    for (const auto& [gid, info] : participants_)
      for (const auto& node : info.node_entities_info_seq) ++names[full_name(node)];
    return names;
  }
  /// `ros2 node info`: names on the wire of what the node writes or reads.
  std::set<std::string> written_by(const std::string& node) const {
    std::set<std::string> topics;
    const std::set<bus::WriterId> ids = ids_of(node, true);
    for (const bus::TopicWriter& writer : bus_->writers())
      if (ids.contains(writer.id)) topics.insert(writer.topic.name);
    return topics;
  }
  std::set<std::string> read_by(const std::string& node) const {
    std::set<std::string> topics;
    const std::set<bus::WriterId> ids = ids_of(node, false);
    for (const bus::TopicReader& reader : bus_->readers())
      if (ids.contains(reader.id)) topics.insert(reader.topic.name);
    return topics;
  }
  /// Ids that nodes announce and discovery does not know.
  std::size_t unknown_endpoints() const {
    std::set<bus::WriterId> known;
    for (const bus::TopicWriter& writer : bus_->writers()) known.insert(writer.id);
    for (const bus::TopicReader& reader : bus_->readers()) known.insert(reader.id);
    std::size_t unknown = 0;
    for (const std::string& node : nodes())
      for (const bool writes : {true, false})
        for (const bus::WriterId& id : ids_of(node, writes)) unknown += known.contains(id) ? 0 : 1;
    return unknown;
  }

  /// `ros2 service type`: of the request, as discovery has it.
  std::string service_type(const std::string& service) const {
    for (const bus::TopicReader& reader : bus_->readers()) {
      if (reader.topic.name != "rq" + service + "Request") continue;
      const std::string type = ros2::ros_type(reader.topic.type);
      return type.substr(0, type.rfind("_Request"));
    }
    return {};
  }

  /// Endpoints that an RMW warns of, by topic. It passes over the built-in ones that Cyclone DDS lists.
  std::vector<std::string> warnings() const {
    std::vector<std::string> topics;
    const auto note = [&](const auto& endpoint, const char* kind) {
      const bool built_in = endpoint.topic.name.starts_with("DCPS");
      if (!built_in && parse_user_data(endpoint.user_data) == UserData::kWarning)
        topics.push_back(endpoint.topic.name + kind);
    };
    for (const bus::TopicWriter& writer : bus_->writers()) note(writer, " (writer)");
    for (const bus::TopicReader& reader : bus_->readers()) note(reader, " (reader)");
    return topics;
  }
  std::size_t endpoints() const { return bus_->writers().size() + bus_->readers().size(); }

  /// Calls a service of a node's parameters; nothing when no answer came.
  template <class Reply, class Request>
  std::optional<Reply> call(const std::string& node, const std::string& service, const std::string& type,
                            const Request& request) {
    using namespace std::chrono_literals;
    const std::string dds = "rcl_interfaces::srv::dds_::" + type, name = node + '/' + service;
    std::mutex mutex;
    std::condition_variable changed;
    std::optional<std::vector<std::byte>> reply;
    const auto client =
        bus_->create_calls({"rq" + name + "Request", dds + "_Request_", "rr" + name + "Reply", dds + "_Response_"},
                           bus::CallRole::kClient, [&](const bus::CallId&, std::span<const std::byte> cdr) {
                             const std::lock_guard lock(mutex);
                             reply.emplace(cdr.begin(), cdr.end());
                             changed.notify_all();
                           });
    for (int i = 0; i < 1000 && (client->matched_readers() < 1 || client->matched_writers() < 1); ++i)
      std::this_thread::sleep_for(10ms);
    const std::vector<std::uint8_t> cdr = ros::encode<ros::Wire::kCdr>(request);
    if (!client->request(std::as_bytes(std::span(cdr)))) return std::nullopt;
    std::unique_lock lock(mutex);
    if (!changed.wait_for(lock, 10s, [&] { return reply.has_value(); })) return std::nullopt;
    return ros::decode<Reply>(ros::Wire::kCdr, {reinterpret_cast<const std::uint8_t*>(reply->data()), reply->size()});
  }

 private:
  static constexpr char kGraphType[] = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

  static bus::BusOptions without_node(bus::BusOptions options) {
    options.ros_graph = "off";
    return options;
  }
  static std::string full_name(const msg::NodeEntitiesInfo<16>& node) {
    return (node.node_namespace == "/" ? "" : node.node_namespace) + '/' + node.node_name;
  }
  void take(const bus::RawSample& sample) {
    const auto cdr = sample.cdr();
    const Info info =
        ros::decode<Info>(ros::Wire::kCdr, {reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()});
    const std::lock_guard lock(mutex_);
    participants_[info.gid.data] = info;
  }
  std::set<bus::WriterId> ids_of(const std::string& name, bool writes) const {
    const std::lock_guard lock(mutex_);
    std::set<bus::WriterId> ids;
    for (const auto& [gid, info] : participants_) {
      for (const auto& node : info.node_entities_info_seq) {
        if (full_name(node) != name) continue;
        for (const auto& endpoint : writes ? node.writer_gid_seq : node.reader_gid_seq) ids.insert(endpoint.data);
      }
    }
    return ids;
  }

  const std::shared_ptr<bus::RawBus> bus_;
  mutable std::mutex mutex_;
  std::map<bus::WriterId, Info> participants_;
  std::unique_ptr<bus::RawReader> reader_;  // last: it uses the others
};

}  // namespace rtd::testing
