// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/ros_graph.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

#include "common/bus/robot.hpp"
#include "common/msg/ros_graph.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::bus {
namespace {

constexpr char kType[] = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

template <std::size_t kBytes>
msg::Gid<kBytes> gid_of(const WriterId& id) {
  msg::Gid<kBytes> gid;
  std::ranges::copy(id, gid.data.begin());
  return gid;
}

template <std::size_t kBytes>
std::vector<std::byte> encode_info(const WriterId& participant, const NodeName& node, const std::set<WriterId>& readers,
                                   const std::set<WriterId>& writers) {
  msg::ParticipantEntitiesInfo<kBytes> info;
  info.gid = gid_of<kBytes>(participant);
  auto& own = info.node_entities_info_seq.emplace_back();
  own.node_namespace = node.space;
  own.node_name = node.name;
  std::ranges::transform(readers, std::back_inserter(own.reader_gid_seq), gid_of<kBytes>);
  std::ranges::transform(writers, std::back_inserter(own.writer_gid_seq), gid_of<kBytes>);
  return ros::encode_cdr(info);
}

/// The name or, where a connection of this process has it already, the name with a number. Free again at its end.
std::shared_ptr<const NodeName> unique_in_process(const NodeName& wanted) {
  static std::mutex mutex;
  static std::set<std::string> taken;
  const std::lock_guard lock(mutex);
  NodeName name = wanted;
  for (int number = 2; !taken.insert(name.space + '/' + name.name).second; ++number)
    name.name = wanted.name + '_' + std::to_string(number);
  return {new NodeName(name), [](const NodeName* old) {
            const std::lock_guard released(mutex);
            taken.erase(old->space + '/' + old->name);
            delete old;
          }};
}

/// As every RMW has it.
RawWriterOptions graph_qos() {
  RawWriterOptions options;
  options.qos.durability = RawQos::Durability::kTransientLocal;
  options.qos.depth = 1;
  return options;
}

}  // namespace

RosGraph ros_graph_of(const BusOptions& options) {
  if (options.ros_graph == "off") return RosGraph::kOff;
  return options.ros_graph == "humble" ? RosGraph::kHumble : RosGraph::kIron;
}

NodeName node_name(const std::string& participant_name, const std::string& robot) {
  NodeName node{robot.empty() ? "/" : "/" + robot, participant_name.empty() ? "rtd" : participant_name};
  std::ranges::replace_if(
      node.name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return node;
}

std::string participant_user_data(const BusOptions& options) {
  return "enclave=" + (options.security.enabled() ? options.security.enclave : "/") + ';';
}

NodeEndpoints::Entry::Entry(NodeEndpoints& endpoints, const std::string& topic, const WriterId& id, Direction direction)
    : endpoints_(topic == kRosGraphTopic ? nullptr : &endpoints), id_(id), direction_(direction) {
  if (endpoints_ != nullptr) endpoints_->change(id_, direction_, true);
}

NodeEndpoints::Entry::~Entry() {
  if (endpoints_ != nullptr) endpoints_->change(id_, direction_, false);
}

void NodeEndpoints::change(const WriterId& id, Direction direction, bool present) {
  const std::lock_guard lock(mutex_);
  std::set<WriterId>& ids = direction == Direction::kReads ? readers_ : writers_;
  present ? (void)ids.insert(id) : (void)ids.erase(id);
  if (on_change_) on_change_(readers_, writers_);
}

void NodeEndpoints::watch(OnChange on_change) {
  const std::lock_guard lock(mutex_);
  on_change_ = std::move(on_change);
  if (on_change_) on_change_(readers_, writers_);
}

std::vector<std::byte> graph_message(RosGraph form, const WriterId& participant, const NodeName& node,
                                     const std::set<WriterId>& readers, const std::set<WriterId>& writers) {
  return form == RosGraph::kHumble ? encode_info<24>(participant, node, readers, writers)
                                   : encode_info<16>(participant, node, readers, writers);
}

NodeAnnouncer::NodeAnnouncer(NodeEndpoints& endpoints, const WriterId& participant, const BusOptions& options,
                             const CreateWriter& create_writer)
    : endpoints_(endpoints) {
  const RosGraph form = ros_graph_of(options);
  if (form == RosGraph::kOff || options.security.enabled()) return;
  name_ = unique_in_process(node_name(options.participant_name, options.robot));
  writer_ = create_writer({std::string(kRosGraphTopic), kType}, graph_qos());
  endpoints_.watch([this, form, participant](const auto& readers, const auto& writers) {
    writer_->write(graph_message(form, participant, *name_, readers, writers));
  });
}

NodeAnnouncer::~NodeAnnouncer() {
  endpoints_.watch(nullptr);
}

}  // namespace rtd::bus
