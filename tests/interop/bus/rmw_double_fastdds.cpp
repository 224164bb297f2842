// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <stdexcept>

#include "common/bus/fastdds/versions/vendor.hpp"
#include "geometry_msgsPubSubTypes.h"
#include "tests/interop/bus/rmw_double.hpp"

namespace rtd::test_support {
namespace {

namespace dds = bus::fastdds::dds;
namespace rtps = bus::fastdds::rtps;
namespace transports = bus::fastdds::transports;

/// Humble: UDP on loopback only.
void keep_to_loopback(dds::DomainParticipantQos& qos) {
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<transports::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().user_transports.push_back(udp);
  qos.transport().user_transports.push_back(std::make_shared<transports::SharedMemTransportDescriptor>());
}

/// Iron and later: no multicast; loopback is asked at the first ports.
void ask_loopback(dds::DomainParticipantQos& qos) {
  auto& builtin = qos.wire_protocol().builtin;
  builtin.metatrafficMulticastLocatorList.clear();
  builtin.metatrafficUnicastLocatorList.push_back(rtps::Locator_t());
  rtps::Locator_t peer;
  rtps::IPLocator::setIPv4(peer, "127.0.0.1");
  builtin.initialPeersList.push_back(peer);
}

template <class Entity>
Entity* required(Entity* entity) {
  if (entity == nullptr) throw std::runtime_error("Fast DDS refused an entity");
  return entity;
}

class FastDouble final : public RmwDouble {
 public:
  FastDouble(const std::string& setting, std::uint32_t domain) {
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    if (setting == "localhost_only=1") keep_to_loopback(qos);
    if (setting == "LOCALHOST") ask_loopback(qos);
    if (setting == "OFF")
      qos.wire_protocol().builtin.discovery_config.discoveryProtocol = bus::fastdds::DiscoveryProtocol::NONE;
    participant_ = required(dds::DomainParticipantFactory::get_instance()->create_participant(domain, qos));
    type_.register_type(participant_);
    dds::DataWriterQos writing = dds::DATAWRITER_QOS_DEFAULT;
    writing.durability().kind = dds::VOLATILE_DURABILITY_QOS;
    writer_ = required(participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT)
                           ->create_datawriter(topic("rt/camera/ground_truth"), writing));
    dds::DataReaderQos reading = dds::DATAREADER_QOS_DEFAULT;
    reading.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    reader_ = required(participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)
                           ->create_datareader(topic("rt/slam/pose"), reading));
  }
  ~FastDouble() override {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  void write() override {
    geometry_msgs::msg::dds_::PoseStamped_ pose;
    pose.pose().orientation().w() = 1;
    writer_->write(&pose);
  }
  int take() override {
    int taken = 0;
    geometry_msgs::msg::dds_::PoseStamped_ pose;
    dds::SampleInfo info;
    while (bus::fastdds::succeeded(reader_->take_next_sample(&pose, &info))) taken += info.valid_data ? 1 : 0;
    return taken;
  }

 private:
  dds::Topic* topic(const char* name) {
    return required(participant_->create_topic(name, type_.get_type_name(), dds::TOPIC_QOS_DEFAULT));
  }

  dds::TypeSupport type_{new geometry_msgs::msg::dds_::PoseStamped_PubSubType()};
  dds::DomainParticipant* participant_ = nullptr;
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;
};

}  // namespace

std::unique_ptr<RmwDouble> double_of_fastrtps(const std::string& setting, std::uint32_t domain) {
  return std::make_unique<FastDouble>(setting, domain);
}

}  // namespace rtd::test_support
