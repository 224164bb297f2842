// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "common/bus/discovery.hpp"
#include "common/bus/fastdds/versions/vendor.hpp"

namespace rtd::bus::fastdds {

/// The enclave's files as Fast DDS's built-in plugins want them. No change without security.
void map_security(const SecurityOptions& security, dds::DomainParticipantQos& qos);

/// Leaves the shared memory that this process uses to its user. Fast DDS lets every user of the host read it, and the
/// raw frames that go through it to readers without our rings are not encrypted.
void hide_shared_memory();

/// Calls BusOptions::on_problem, once each, for participants that a secured one cannot match. Thread-safe.
class SecurityWatch {
 public:
  explicit SecurityWatch(const BusOptions& options);
  void discovered(const FoundParticipant& participant);
  void refused(const ParticipantId& participant);

 private:
  const std::uint32_t domain_;
  const std::function<void(const std::string&)> on_problem_;
  std::mutex mutex_;
  std::map<ParticipantId, std::string> names_;  ///< of those not reported yet; else empty
};

/// Announces our participant again to others that have just appeared. Fast DDS 2.9 answers a new participant's first
/// announcement once, but it announces itself some milliseconds before it can receive: an answer that comes too early
/// is lost, and the two match only at our next periodic announcement, half a second later. Thread-safe.
class AnnouncementRepeater {
 public:
  ~AnnouncementRepeater() { stop(); }
  void start(dds::DomainParticipant& participant);
  /// Afterwards the participant is not touched. To be called before it is deleted.
  void stop();
  /// A participant has appeared.
  void announce_again();

 private:
  void loop(dds::DomainParticipant& participant);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t appeared_ = 0;
  bool ended_ = false;
  std::thread thread_;
};

/// Calls BusOptions::on_problem when the Discovery Server does not answer within kServerPatience: without it no
/// participant is found, and Fast DDS continues asking without a message. Thread-safe.
class ServerWatch {
 public:
  ~ServerWatch() { stop(); }
  /// Does nothing without a server in the options.
  void start(const BusOptions& options);
  void stop();
  void appeared(const ParticipantId& participant);

 private:
  std::stop_source settled_;  ///< found, or to be stopped
  std::thread thread_;
};

/// Receives what Fast DDS discovers of the other participants of a domain and of their endpoints.
class DiscoveryListener : public DiscoveryAdapter {
 public:
  /// `registry`, if any, gets all endpoints and participants.
  DiscoveryListener(const BusOptions& options, EndpointRegistry* registry);
  void start(dds::DomainParticipant& participant, const BusOptions& options);
  void stop();
  TopicTypes& types() { return types_; }

 private:
  void found(const FoundParticipant& participant) override;
  void refused(const ParticipantId& participant) override;
  void found(const TopicWriter& writer, bool gone) override;
  void found(const TopicReader& reader, bool gone) override;

  EndpointRegistry* const registry_;
  std::unique_ptr<SecurityWatch> security_;
  AnnouncementRepeater announcements_;
  ServerWatch server_;
  TopicTypes types_;
};

}  // namespace rtd::bus::fastdds
