// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/discovery_listener.hpp"

#include <algorithm>
#include <chrono>
#include <sstream>
#include <string>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/network_mapping.hpp"
#include "common/bus/fastdds/qos_mapping.hpp"
#include "common/bus/network.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// After a participant has appeared; the second one is for a busy host.
constexpr std::chrono::milliseconds kDelays[] = {std::chrono::milliseconds(30), std::chrono::milliseconds(80)};

/// A participant announces itself at once when its user data changes. Keys that a reader does not know mean nothing to
/// it, in ROS 2 neither.
void announce(dds::DomainParticipant& participant, std::uint64_t count) {
  dds::DomainParticipantQos qos = participant.get_qos();
  const auto& before = qos.user_data().getValue();
  std::string text(before.begin(), before.end());
  text = text.substr(0, text.find("greeting=")) + "greeting=" + std::to_string(count) + ';';
  qos.user_data().setValue({text.begin(), text.end()});
  participant.set_qos(qos);
}

bool is_own(const dds::DomainParticipant& participant, const rtps::GUID_t& endpoint) {
  return endpoint.guidPrefix == participant.guid().guidPrefix;
}

/// `Info`: of a writer or of a reader.
template <class Info>
void note_type(const dds::DomainParticipant& participant, const Info& info, bool gone, TopicTypes& types) {
  if (is_own(participant, info.guid())) return;
  std::ostringstream id;
  id << info.guid();
  if (gone) {
    types.gone(id.str());
  } else {
    types.appeared(id.str(), info.topicName().to_string(), info.typeName().to_string());
  }
}

ParticipantId id_of(const rtps::GuidPrefix_t& prefix) {
  ParticipantId id{};
  std::copy_n(prefix.value, id.size(), id.begin());
  return id;
}

}  // namespace

void Reannouncer::start(dds::DomainParticipant& participant) {
  thread_ = std::thread([this, &participant] { loop(participant); });
}

void Reannouncer::stop() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Reannouncer::announce_again() {
  {
    const std::lock_guard lock(mutex_);
    ++appeared_;
  }
  changed_.notify_all();
}

void Reannouncer::loop(dds::DomainParticipant& participant) {
  std::unique_lock lock(mutex_);
  std::uint64_t answered = 0, announcements = 0;
  const auto ended = [this] { return ended_; };
  while (true) {
    changed_.wait(lock, [&] { return ended_ || appeared_ > answered; });
    answered = appeared_;
    for (const auto delay : kDelays) {
      if (changed_.wait_for(lock, delay, ended)) return;
      lock.unlock();
      announce(participant, ++announcements);
      lock.lock();
    }
  }
}

void ServerWatch::start(const BusOptions& options) {
  if (options.network.discovery_server.empty() || !options.on_problem) return;
  thread_ = std::thread([options, settled = settled_.get_token()] {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any().wait_for(lock, settled, kServerPatience, [] { return false; });
    if (!settled.stop_requested()) options.on_problem(no_server_problem(options));
  });
}

void ServerWatch::stop() {
  settled_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void ServerWatch::appeared(const rtps::GuidPrefix_t& participant) {
  if (participant == server_prefix()) settled_.request_stop();
}

DiscoveryListener::DiscoveryListener(const BusOptions& options, EndpointRegistry* registry)
    : registry_(registry), security_(options.security.enabled() ? std::make_unique<SecurityWatch>(options) : nullptr) {}

void DiscoveryListener::start(dds::DomainParticipant& participant, const BusOptions& options) {
  reannouncer_.start(participant);
  server_.start(options);
  if (registry_) registry_->note(id_of(participant.guid().guidPrefix), participant.get_qos().name().to_string());
}

void DiscoveryListener::stop() {
  reannouncer_.stop();
  server_.stop();
}

void DiscoveryListener::on_participant_discovery(Participant*, rtps::ParticipantDiscoveryInfo&& info) {
  if (security_) security_->discovered(info);
  note(info);
  if (info.status != rtps::ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT) return;
  reannouncer_.announce_again();
  server_.appeared(info.info.m_guid.guidPrefix);
}

void DiscoveryListener::note(const rtps::ParticipantDiscoveryInfo& info) {
  if (!registry_) return;
  using Info = rtps::ParticipantDiscoveryInfo;
  const bool gone = info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT;
  const ParticipantId id = id_of(info.info.m_guid.guidPrefix);
  gone ? registry_->note_gone(id) : registry_->note(id, info.info.m_participantName.to_string());
}

void DiscoveryListener::onParticipantAuthentication(Participant*, rtps::ParticipantAuthenticationInfo&& info) {
  if (security_) security_->authenticated(info);
}

void DiscoveryListener::on_publisher_discovery(Participant* participant, rtps::WriterDiscoveryInfo&& info) {
  const bool gone = info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER;
  note_type(*participant, info.info, gone, types_);
  if (registry_ == nullptr) return;
  TopicWriter writer = to_topic_writer(info.info);
  if (gone) return registry_->note_gone(writer.id);
  writer.own = is_own(*participant, info.info.guid());
  registry_->note(writer);
}

void DiscoveryListener::on_subscriber_discovery(Participant* participant, rtps::ReaderDiscoveryInfo&& info) {
  const bool gone = info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER;
  note_type(*participant, info.info, gone, types_);
  if (!registry_) return;
  const rtps::ReaderProxyData& data = info.info;
  const WriterId id = to_writer_id(data.guid());
  if (gone) return registry_->note_gone(id);
  const RawTopic topic{data.topicName().to_string(), data.typeName().to_string(), data.topicKind() == rtps::WITH_KEY};
  const auto& announced = data.m_qos.m_userData;
  registry_->note(TopicReader{id, topic, is_own(*participant, data.guid()), {announced.begin(), announced.end()}});
}

}  // namespace rtd::bus::fastdds
