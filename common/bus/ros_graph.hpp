// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/raw_bus.hpp"

/// Nodes of ROS 2. DDS knows participants and endpoints only; every participant of ROS 2 announces the nodes that it
/// has, with their endpoints, in one latched message on the topic ros_discovery_info. `ros2 node list`, `ros2 node
/// info` and rqt_graph show what they find there. Each of our connections is one node.
namespace rtd::bus {

/// A node by its two names: "/" and "rtd_slam", "/anna" and "rtd_slam".
struct NodeName {
  std::string space, name;
};
/// The node of a connection, by its participant's name and its robot.
NodeName node_name(const std::string& participant_name, const std::string& robot);

/// What a participant says about itself in its USER_DATA: the enclave, as every node of ROS 2 does.
std::string participant_user_data(const BusOptions& options);

/// The endpoints of one participant. Thread-safe.
class NodeEndpoints {
 public:
  enum class Direction { kReads, kWrites };

  /// One of our endpoints, as long as it lives.
  class Entry {
   public:
    Entry(NodeEndpoints& endpoints, const std::string& topic, const WriterId& id, Direction direction);
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

   private:
    NodeEndpoints* endpoints_;  ///< nullptr: not a topic of the node
    const WriterId id_;
    const Direction direction_;
  };

  using OnChange = std::function<void(const std::set<WriterId>& readers, const std::set<WriterId>& writers)>;
  /// Calls it now and after each change, one call at a time. Empty: no more.
  void watch(OnChange on_change);

 private:
  void change(const WriterId& id, Direction direction, bool present);

  std::mutex mutex_;
  std::set<WriterId> readers_, writers_;
  OnChange on_change_;
};

/// The message of a participant with one node, in CDR. Endpoints in the order of their ids.
std::vector<std::byte> graph_message(RosGraph form, const WriterId& participant, const NodeName& node,
                                     const std::set<WriterId>& readers, const std::set<WriterId>& writers);

/// Announces the node of a participant while it lives. Further connections of a process under the same name are nodes
/// with a number behind it: "rtd_camera_2".
class NodeAnnouncer {
 public:
  using CreateWriter = std::function<std::unique_ptr<RawWriter>(const RawTopic&, const RawWriterOptions&)>;

  /// Does nothing when the options say so, or in a secured domain.
  NodeAnnouncer(NodeEndpoints& endpoints, const WriterId& participant, const BusOptions& options,
                const CreateWriter& create_writer);
  ~NodeAnnouncer();
  NodeAnnouncer(const NodeAnnouncer&) = delete;
  NodeAnnouncer& operator=(const NodeAnnouncer&) = delete;

 private:
  NodeEndpoints& endpoints_;
  std::shared_ptr<const NodeName> name_;
  std::unique_ptr<RawWriter> writer_;
};

}  // namespace rtd::bus
