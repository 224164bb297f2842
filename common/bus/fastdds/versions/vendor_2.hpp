// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastdds/rtps/builtin/data/WriterProxyData.h>
#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <fastrtps/config.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/fastdds/versions/discovery_events.hpp"
#include "common/bus/fastdds/versions/type_functions.hpp"
#include "common/bus/host/shm_names.hpp"

/// Fast DDS 2, from 2.9 on.
namespace rtd::bus::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
namespace transports = eprosima::fastdds::rtps;
using DiscoveryProtocol = rtps::DiscoveryProtocol_t;
using eprosima::fastrtps::c_TimeInfinite;
using eprosima::fastrtps::Duration_t;

inline constexpr std::string_view kShmPrefix = kShmNames[0];
inline constexpr std::uint64_t kVersion =
    10'000 * FASTRTPS_VERSION_MAJOR + 100 * FASTRTPS_VERSION_MINOR + FASTRTPS_VERSION_MICRO;

inline bool succeeded(const eprosima::fastrtps::types::ReturnCode_t& code) {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}
inline bool succeeded(bool written) {
  return written;
}

/// Type support: name, largest size and whether there are keys, and the functions of the type.
class TypeSupportBase : public dds::TopicDataType, public TypeFunctions {
 public:
  TypeSupportBase(const std::string& name, std::uint32_t largest, bool keyed) {
    setName(name.c_str());
    m_typeSize = largest;
    m_isGetKeyDefined = keyed;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) final {
    return write_payload(*this, data, *payload, CDR_LE, CDR_BE);
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) final {
    return read({payload->data, payload->length}, data);
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) final {
    return [this, data] { return size_of(data); };
  }
  void* createData() final { return create(); }
  void deleteData(void* data) final { destroy(data); }
  bool getKey(void*, rtps::InstanceHandle_t* handle, bool) final { return m_isGetKeyDefined && only_instance(*handle); }
  bool is_bounded() const final { return plain(); }
  bool is_plain() const final { return plain(); }
};

/// What a reader that is created takes at most, and what a writer that is created announces.
inline std::uint32_t& largest_sample(dds::TopicDataType& type) {
  return type.m_typeSize;
}

/// What discovery finds of a writer.
struct PublicationData {
  explicit PublicationData(const rtps::WriterProxyData& data)
      : guid(data.guid()),
        topic_name(data.topicName()),
        type_name(data.typeName()),
        topic_kind(data.topicKind()),
        user_data(data.m_qos.m_userData),
        data_sharing(data.m_qos.data_sharing),
        reliability(data.m_qos.m_reliability),
        durability(data.m_qos.m_durability),
        deadline(data.m_qos.m_deadline),
        lifespan(data.m_qos.m_lifespan),
        liveliness(data.m_qos.m_liveliness) {}
  const rtps::GUID_t& guid;
  const eprosima::fastrtps::string_255 &topic_name, &type_name;
  rtps::TopicKind_t topic_kind;
  const dds::UserDataQosPolicy& user_data;
  const dds::DataSharingQosPolicy& data_sharing;
  const dds::ReliabilityQosPolicy& reliability;
  const dds::DurabilityQosPolicy& durability;
  const dds::DeadlineQosPolicy& deadline;
  const dds::LifespanQosPolicy& lifespan;
  const dds::LivelinessQosPolicy& liveliness;
};

WriterId to_writer_id(const rtps::GUID_t& guid);
TopicWriter to_topic_writer(const PublicationData& data);

/// Of a participant whose events go to DiscoveryEvents.
class DiscoveryAdapter : public dds::DomainParticipantListener, public DiscoveryEvents {
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) override {
    using Info = rtps::ParticipantDiscoveryInfo;
    using Change = FoundParticipant::Change;
    const bool gone = info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT;
    const Change change =
        gone ? Change::kGone : (info.status == Info::DISCOVERED_PARTICIPANT ? Change::kAppeared : Change::kChanged);
    const rtps::ParticipantProxyData& data = info.info;
    found(FoundParticipant{change, participant_of(to_writer_id(data.m_guid)), data.m_participantName.to_string(),
                           data.m_VendorId});
  }
  void onParticipantAuthentication(dds::DomainParticipant*, rtps::ParticipantAuthenticationInfo&& info) override {
    if (info.status != rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT)
      refused(participant_of(to_writer_id(info.guid)));
  }
  void on_publisher_discovery(dds::DomainParticipant* participant, rtps::WriterDiscoveryInfo&& info) override {
    TopicWriter writer = to_topic_writer(PublicationData(info.info));
    writer.own = info.info.guid().guidPrefix == participant->guid().guidPrefix;
    found(writer, info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
  }
  void on_subscriber_discovery(dds::DomainParticipant* participant, rtps::ReaderDiscoveryInfo&& info) override {
    const rtps::ReaderProxyData& data = info.info;
    found(TopicReader{to_writer_id(data.guid()),
                      {data.topicName().to_string(), data.typeName().to_string(), data.topicKind() == rtps::WITH_KEY},
                      data.guid().guidPrefix == participant->guid().guidPrefix,
                      {data.m_qos.m_userData.begin(), data.m_qos.m_userData.end()}},
          info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
  }
};

/// A transport that sends by the one behind it, unchanged. What comes is for receive().
class PassingTransport : public transports::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;
  bool send(rtps::SenderResource* sender, const rtps::octet* data, std::uint32_t size, rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    return sender->send(data, size, begin, end, timeout);
  }
  bool transform_remote_locator(const rtps::Locator_t& remote, rtps::Locator_t& result) const override {
    return ChainingTransport::transform_remote_locator(remote, result) || reach(remote, result);
  }
  /// By which address to send to one that the transport behind does not reach.
  virtual bool reach(const rtps::Locator_t& /*remote*/, rtps::Locator_t& /*result*/) const { return false; }
};

/// The transport as it is: what it receives needs no change.
inline std::shared_ptr<transports::TransportDescriptorInterface> as_received(
    std::shared_ptr<transports::SharedMemTransportDescriptor> transport) {
  return transport;
}

/// Heartbeats of a writer, and how soon it repairs.
inline void set_timing(dds::DataWriterQos& qos, const Duration_t& first, const Duration_t& period,
                       const Duration_t& response) {
  qos.reliable_writer_qos().times.initialHeartbeatDelay = first;
  qos.reliable_writer_qos().times.heartbeatPeriod = period;
  qos.reliable_writer_qos().times.nackResponseDelay = response;
}

/// How soon a reader asks for what is missing.
inline void set_timing(dds::DataReaderQos& qos, const Duration_t& response) {
  qos.reliable_reader_qos().times.heartbeatResponseDelay = response;
}

inline void set_representations(dds::DataReaderQos& qos, std::vector<dds::DataRepresentationId_t> representations) {
  qos.type_consistency().representation.m_value = std::move(representations);
}

inline void add_discovery_server(rtps::BuiltinAttributes& builtin, const rtps::Locator_t& address, const char* prefix) {
  rtps::RemoteServerAttributes server;
  server.ReadguidPrefix(prefix);
  server.metatrafficUnicastLocatorList.push_back(address);
  builtin.discovery_config.m_DiscoveryServers.push_back(server);
}

/// Between participants of one process.
inline void turn_off_direct_calls() {
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

}  // namespace rtd::bus::fastdds
