// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/discovery_listener.hpp"
#include "common/bus/host/host_checks.hpp"
#include "common/bus/host/ring_folder.hpp"
#include "common/bus/ros_graph.hpp"

namespace rtd::bus::fastdds {

/// Participant ids choose port numbers. A process must not get the shared-memory port of one that was killed: others
/// keep that port in memory as long as they run, and may write to it in vain, for seconds or for good. So the id
/// follows the process id, and the next one is taken while it is one of `taken`, or there is a port of that number in
/// `shm_dir`, in use or left behind. Nothing when there is no other: then only UDP is safe.
std::optional<std::uint32_t> free_participant_id(int domain, std::uint32_t first,
                                                 const std::set<std::uint32_t>& taken = {},
                                                 const std::filesystem::path& shm_dir = kShmFolder);

/// Our participant in a domain: transports, publisher, subscriber and topics. Thread-safe.
class Participant {
 public:
  /// Throws BusError when Fast DDS refuses. `registry`, if any, gets all writers of the domain from the first one on;
  /// `node`, if any, its endpoints, else one of its own.
  Participant(const BusOptions& options, const HostLimits& limits, EndpointRegistry* registry = nullptr,
              std::shared_ptr<NodeEndpoints> node = nullptr);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// For endpoints of the topic of that name: stays_on_host() decides.
  dds::Publisher& publisher(const std::string& topic);
  dds::Subscriber& subscriber(const std::string& topic);
  /// The topic of that name, created when new; lives as long as the participant.
  /// Throws BusError when it exists with another type.
  dds::Topic* topic(const std::string& name, const Codec& codec);
  /// A reader that gives up samples of more than `largest` bytes at their first fragment. nullptr: refused.
  dds::DataReader* create_reader(dds::Topic& topic, const dds::DataReaderQos& qos, std::size_t largest,
                                 dds::DataReaderListener& listener);
  TopicTypes& types() { return listener_.types(); }
  WriterId id() const;
  /// What is announced to ROS 2: endpoints enter themselves.
  NodeEndpoints& node_endpoints() { return *node_endpoints_; }
  /// What is discovered from now on goes to this listener, which outlives the participant or is silenced, instead of
  /// to ours.
  void observe(dds::DomainParticipantListener& listener) {
    participant_->set_listener(&listener, dds::StatusMask::none());
  }
  /// No listener is called any more.
  void silence() { participant_->set_listener(nullptr); }
  /// Where its endpoints have the rings of frames (place_ring()); empty: nowhere.
  std::string rings() const;
  /// The partitions of such an endpoint as Fast DDS's property of that name has them; empty: as all others of the
  /// topic. In a run readers of frames ask for its rings alone, and what others write costs them nothing.
  std::string ring_partitions(const std::string& folder, bool writes) const;
  /// Held while Fast DDS creates an endpoint, which reads the size of its type, or deletes a reader: its list of
  /// readers with a liveliness has no lock of its own where it shrinks.
  std::mutex& endpoints_mutex() { return endpoints_mutex_; }

 private:
  void create_publishers(const NetworkOptions& network);

  const BusOptions options_;
  const std::shared_ptr<NodeEndpoints> node_endpoints_;
  DiscoveryListener listener_;                              // outlives the participant, which calls it
  std::shared_ptr<dds::DomainParticipantFactory> factory_;  // keeps the vendor's singleton alive
  dds::DomainParticipant* participant_ = nullptr;
  std::uint32_t participant_id_ = 0;
  dds::Publisher *publisher_ = nullptr, *host_publisher_ = nullptr;
  dds::Subscriber *subscriber_ = nullptr, *host_subscriber_ = nullptr;
  std::mutex topics_mutex_, endpoints_mutex_;
};

}  // namespace rtd::bus::fastdds
