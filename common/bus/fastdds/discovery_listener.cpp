// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/discovery_listener.hpp"

#include <chrono>
#include <string>

#include "common/bus/fastdds/network_mapping.hpp"
#include "common/bus/network.hpp"

namespace rtd::bus::fastdds {
namespace {

/// After a participant has appeared; the second one is for a busy host.
constexpr std::chrono::milliseconds kDelays[] = {std::chrono::milliseconds(30), std::chrono::milliseconds(80)};

/// A participant announces itself at once when its user data changes. Keys that a reader does not know mean nothing to
/// it, in ROS 2 neither.
void announce(dds::DomainParticipant& participant, std::uint64_t count) {
  dds::DomainParticipantQos qos = participant.get_qos();
  const auto& before = qos.user_data().getValue();
  std::string text(before.begin(), before.end());
  text = text.substr(0, text.find("announcement=")) + "announcement=" + std::to_string(count) + ';';
  qos.user_data().setValue({text.begin(), text.end()});
  participant.set_qos(qos);
}

/// `Endpoint`: TopicWriter or TopicReader.
template <class Endpoint>
void note_type(const Endpoint& endpoint, bool gone, TopicTypes& types) {
  if (endpoint.own) return;
  if (gone) return types.gone(to_string(endpoint.id));
  types.appeared(to_string(endpoint.id), endpoint.topic.name, endpoint.topic.type);
}

}  // namespace

void AnnouncementRepeater::start(dds::DomainParticipant& participant) {
  thread_ = std::thread([this, &participant] { loop(participant); });
}

void AnnouncementRepeater::stop() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void AnnouncementRepeater::announce_again() {
  {
    const std::lock_guard lock(mutex_);
    ++appeared_;
  }
  changed_.notify_all();
}

void AnnouncementRepeater::loop(dds::DomainParticipant& participant) {
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

void ServerWatch::appeared(const ParticipantId& participant) {
  if (participant == server_id()) settled_.request_stop();
}

DiscoveryListener::DiscoveryListener(const BusOptions& options, EndpointRegistry* registry)
    : registry_(registry), security_(options.security.enabled() ? std::make_unique<SecurityWatch>(options) : nullptr) {}

void DiscoveryListener::start(dds::DomainParticipant& participant, const BusOptions& options) {
  announcements_.start(participant);
  server_.start(options);
  if (registry_)
    registry_->note(participant_of(to_writer_id(participant.guid())), participant.get_qos().name().to_string());
}

void DiscoveryListener::stop() {
  announcements_.stop();
  server_.stop();
}

void DiscoveryListener::found(const FoundParticipant& participant) {
  using Change = FoundParticipant::Change;
  if (security_) security_->discovered(participant);
  if (registry_ && participant.change == Change::kGone) registry_->note_gone(participant.id);
  if (registry_ && participant.change != Change::kGone) registry_->note(participant.id, participant.name);
  if (participant.change != Change::kAppeared) return;
  announcements_.announce_again();
  server_.appeared(participant.id);
}

void DiscoveryListener::refused(const ParticipantId& participant) {
  if (security_) security_->refused(participant);
}

void DiscoveryListener::found(const TopicWriter& writer, bool gone) {
  note_type(writer, gone, types_);
  if (registry_) gone ? registry_->note_gone(writer.id) : registry_->note(writer);
}

void DiscoveryListener::found(const TopicReader& reader, bool gone) {
  note_type(reader, gone, types_);
  if (registry_) gone ? registry_->note_gone(reader.id) : registry_->note(reader);
}

}  // namespace rtd::bus::fastdds
