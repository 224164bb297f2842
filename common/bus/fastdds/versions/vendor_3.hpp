// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/LibrarySettings.hpp>
#include <fastdds/config.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/common/SerializedPayload.hpp>
#include <fastdds/rtps/common/WriteParams.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/fastdds/screening/rtps_screen.hpp"
#include "common/bus/fastdds/versions/discovery_events.hpp"
#include "common/bus/fastdds/versions/type_functions.hpp"
#include "common/bus/host/shm_names.hpp"

/// Fast DDS 3.
namespace rtd::bus::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastdds::rtps;
namespace transports = eprosima::fastdds::rtps;
using dds::c_TimeInfinite;
using dds::Duration_t;
using PublicationData = rtps::PublicationBuiltinTopicData;
using DiscoveryProtocol = rtps::DiscoveryProtocol;

inline constexpr std::string_view kShmPrefix = kShmNames[1];
inline constexpr std::uint64_t kVersion =
    10'000 * FASTDDS_VERSION_MAJOR + 100 * FASTDDS_VERSION_MINOR + FASTDDS_VERSION_MICRO;

inline bool succeeded(dds::ReturnCode_t code) {
  return code == dds::RETCODE_OK;
}

/// Type support: name, largest size and whether there are keys, and the functions of the type.
class TypeSupportBase : public dds::TopicDataType, public TypeFunctions {
 public:
  TypeSupportBase(const std::string& name, std::uint32_t largest, bool keyed) {
    set_name(name);
    max_serialized_type_size = largest;
    is_compute_key_provided = keyed;
  }
  bool serialize(const void* data, rtps::SerializedPayload_t& payload, dds::DataRepresentationId_t) final {
    return write_payload(*this, data, payload, CDR_LE, CDR_BE);
  }
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) final {
    return read({payload.data, payload.length}, data);
  }
  std::uint32_t calculate_serialized_size(const void* data, dds::DataRepresentationId_t) final { return size_of(data); }
  void* create_data() final { return create(); }
  void delete_data(void* data) final { destroy(data); }
  bool compute_key(rtps::SerializedPayload_t&, rtps::InstanceHandle_t& handle, bool) final {
    return is_compute_key_provided && only_instance(handle);
  }
  bool compute_key(const void*, rtps::InstanceHandle_t& handle, bool) final {
    return is_compute_key_provided && only_instance(handle);
  }
  bool is_bounded() const final { return plain(); }
  bool is_plain(dds::DataRepresentationId_t) const final { return plain(); }
};

/// What a reader that is created takes at most, and what a writer that is created announces.
inline std::uint32_t& largest_sample(dds::TopicDataType& type) {
  return type.max_serialized_type_size;
}

WriterId to_writer_id(const rtps::GUID_t& guid);
TopicWriter to_topic_writer(const PublicationData& data);

/// Of a participant whose events go to DiscoveryEvents. In a secured domain version 3 finds only those that have
/// authenticated themselves, and reports by refused() those that cannot.
class DiscoveryAdapter : public dds::DomainParticipantListener, public DiscoveryEvents {
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryStatus status,
                                const dds::ParticipantBuiltinTopicData& info, bool&) override {
    using Status = rtps::ParticipantDiscoveryStatus;
    using Change = FoundParticipant::Change;
    const bool gone = status == Status::REMOVED_PARTICIPANT || status == Status::DROPPED_PARTICIPANT;
    const Change change =
        gone ? Change::kGone : (status == Status::DISCOVERED_PARTICIPANT ? Change::kAppeared : Change::kChanged);
    found(FoundParticipant{change, participant_of(to_writer_id(info.guid)), info.participant_name.to_string(),
                           info.vendor_id});
  }
  void onParticipantAuthentication(dds::DomainParticipant*, rtps::ParticipantAuthenticationInfo&& info) override {
    if (info.status != rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT)
      refused(participant_of(to_writer_id(info.guid)));
  }
  void on_data_writer_discovery(dds::DomainParticipant* participant, rtps::WriterDiscoveryStatus status,
                                const dds::PublicationBuiltinTopicData& info, bool&) override {
    TopicWriter writer = to_topic_writer(info);
    writer.own = info.guid.guidPrefix == participant->guid().guidPrefix;
    found(writer, status == rtps::WriterDiscoveryStatus::REMOVED_WRITER);
  }
  void on_data_reader_discovery(dds::DomainParticipant* participant, rtps::ReaderDiscoveryStatus status,
                                const dds::SubscriptionBuiltinTopicData& info, bool&) override {
    found(TopicReader{to_writer_id(info.guid),
                      {info.topic_name.to_string(), info.type_name.to_string(), info.topic_kind == rtps::WITH_KEY},
                      info.guid.guidPrefix == participant->guid().guidPrefix,
                      {info.user_data.begin(), info.user_data.end()}},
          status == rtps::ReaderDiscoveryStatus::REMOVED_READER);
  }
};

/// A transport that sends by the one behind it, unchanged. What comes is for receive().
///
/// Opens what Fast DDS has not opened before it sends there: version 3.1 as Debian builds it ends the process otherwise
/// (an assertion of its statistics, as in eProsima/Fast-DDS#3285). Fast DDS opens and sends under one lock.
class PassingTransport : public transports::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;
  bool OpenOutputChannel(transports::SendResourceList& senders, const rtps::Locator_t& to) override {
    const bool open = ChainingTransport::OpenOutputChannel(senders, to);
    if (open) open_.insert(to);
    return open;
  }
  bool send(rtps::SenderResource* sender, const std::vector<transports::NetworkBuffer>& buffers, std::uint32_t bytes,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    std::vector<rtps::Locator_t> all;
    for (; *begin != *end; ++*begin) all.push_back(**begin);
    for (const rtps::Locator_t& to : all) {
      transports::SendResourceList none;  // all sockets are there
      if (IsLocatorSupported(to) && open_.count(to) == 0) OpenOutputChannel(none, to);
    }
    rtps::Locators first(all.begin()), last(all.end());
    return sender->send(buffers, bytes, &first, &last, timeout);
  }
  bool transform_remote_locator(const rtps::Locator_t& remote, rtps::Locator_t& result) const override {
    return ChainingTransport::transform_remote_locator(remote, result) || reach(remote, result);
  }
  bool transform_remote_locator(const rtps::Locator_t& remote, rtps::Locator_t& result, bool allowed_remotely,
                                bool allowed_here) const override {
    return ChainingTransport::transform_remote_locator(remote, result, allowed_remotely, allowed_here) ||
           reach(remote, result);
  }
  /// By which address to send to one that the transport behind does not reach.
  virtual bool reach(const rtps::Locator_t& /*remote*/, rtps::Locator_t& /*result*/) const { return false; }

 private:
  std::set<rtps::Locator_t> open_;
};

class SharedMemoryDescriptor : public transports::ChainingTransportDescriptor {
 public:
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  transports::TransportInterface* create_transport() const override;
};

/// Each message of Fast DDS 3.1 ends with a submessage of statistics, of which nothing is written in shared memory:
/// there are bytes of older messages, which its receivers read as submessages. Once in a while it is a heartbeat of
/// samples that do not exist, and a reader that has lost one waits for it from then on and receives nothing more.
class SharedMemoryTransport : public transports::ChainingTransport {
 public:
  explicit SharedMemoryTransport(const SharedMemoryDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}
  transports::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  bool send(rtps::SenderResource* sender, const std::vector<transports::NetworkBuffer>& buffers, std::uint32_t bytes,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return sender->send(buffers, bytes, begin, end, timeout);
  }
  void receive(transports::TransportReceiverInterface* next, const rtps::octet* data, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    constexpr std::size_t kStatistics = 60;
    const auto message = without_last(std::as_bytes(std::span(data, size)), kStatistics);
    next->OnDataReceived(data, static_cast<std::uint32_t>(message.size()), local, remote);
  }

 private:
  SharedMemoryDescriptor descriptor_;
};

inline transports::TransportInterface* SharedMemoryDescriptor::create_transport() const {
  return new SharedMemoryTransport(*this);
}

inline std::shared_ptr<transports::TransportDescriptorInterface> as_received(
    std::shared_ptr<transports::SharedMemTransportDescriptor> transport) {
  return std::make_shared<SharedMemoryDescriptor>(std::move(transport));
}

/// Heartbeats of a writer, and how soon it repairs.
inline void set_timing(dds::DataWriterQos& qos, const Duration_t& first, const Duration_t& period,
                       const Duration_t& response) {
  qos.reliable_writer_qos().times.initial_heartbeat_delay = first;
  qos.reliable_writer_qos().times.heartbeat_period = period;
  qos.reliable_writer_qos().times.nack_response_delay = response;
}

/// How soon a reader asks for what is missing.
inline void set_timing(dds::DataReaderQos& qos, const Duration_t& response) {
  qos.reliable_reader_qos().times.heartbeat_response_delay = response;
}

inline void set_representations(dds::DataReaderQos& qos, std::vector<dds::DataRepresentationId_t> representations) {
  qos.representation().m_value = std::move(representations);
}

inline void add_discovery_server(rtps::BuiltinAttributes& builtin, const rtps::Locator_t& address, const char*) {
  builtin.discovery_config.m_DiscoveryServers.push_back(address);
}

/// Between participants of one process.
inline void turn_off_direct_calls() {
  eprosima::fastdds::LibrarySettings settings;
  settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  dds::DomainParticipantFactory::get_instance()->set_library_settings(settings);
}

}  // namespace rtd::bus::fastdds
