// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/discovery_listener.hpp"
#include "common/bus/host/shm_names.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "common/bus/fastdds/network_mapping.hpp"
#include "common/bus/network.hpp"
#include "common/bus/security_guard.hpp"

namespace rtd::bus::fastdds {
namespace {

using Vendor = std::array<std::uint8_t, 2>;

std::string vendor_name(const Vendor& id) {
  if (id == Vendor{0x01, 0x10}) return "Cyclone DDS";
  if (id == Vendor{0x01, 0x01}) return "RTI Connext DDS";
  if (id == Vendor{0x01, 0x03}) return "OpenDDS";
  std::ostringstream text;
  text << "another DDS (vendor " << std::hex << int{id[0]} << '.' << int{id[1]} << ')';
  return text.str();
}

/// The first bit of a participant's GUID is set where the rest is made of its certificate (DDS-Security 1.1, 8.4.2.5).
bool has_certificate(const ParticipantId& participant) {
  return (participant[0] & 0x80U) != 0;
}

std::string name_of(const FoundParticipant& participant) {
  return (participant.name.empty() ? "" : "'" + participant.name + "' ") + to_string(participant.id);
}

}  // namespace

void map_security(const SecurityOptions& security, dds::DomainParticipantQos& qos) {
  if (!security.enabled()) return;
  const security::EnclaveFiles files = security::KeystoreLayout{security.keystore}.enclave(security.enclave);
  const auto add = [&qos](const std::string& name, const std::string& value) {
    qos.properties().properties().emplace_back("dds.sec." + name, value);
  };
  const auto file = [&add](const std::string& name, const std::filesystem::path& path) {
    add(name, "file://" + std::filesystem::absolute(path).string());
  };
  add("auth.plugin", "builtin.PKI-DH");
  file("auth.builtin.PKI-DH.identity_ca", files.identity_ca());
  file("auth.builtin.PKI-DH.identity_certificate", files.certificate());
  file("auth.builtin.PKI-DH.private_key", files.key());
  add("access.plugin", "builtin.Access-Permissions");
  file("access.builtin.Access-Permissions.permissions_ca", files.permissions_ca());
  file("access.builtin.Access-Permissions.governance", files.governance());
  file("access.builtin.Access-Permissions.permissions", files.permissions());
  add("crypto.plugin", "builtin.AES-GCM-GMAC");
}

void hide_shared_memory() {
  namespace fs = std::filesystem;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t at = line.find(kFastddsPaths);
    if (at == std::string::npos || line.ends_with(" (deleted)")) continue;
    std::error_code not_ours;  // what another user has mapped for us is his
    fs::permissions(line.substr(at), fs::perms::owner_read | fs::perms::owner_write, not_ours);
  }
}

SecurityWatch::SecurityWatch(const BusOptions& options)
    : domain_(options.domain), on_problem_(options.on_problem ? options.on_problem : [](const std::string&) {}) {}

void SecurityWatch::discovered(const FoundParticipant& participant) {
  constexpr Vendor kFastDds = {0x01, 0x0f};
  const std::lock_guard lock(mutex_);
  if (participant.change == FoundParticipant::Change::kGone) {
    names_.erase(participant.id);
    return;
  }
  const auto [known, is_new] = names_.try_emplace(participant.id, name_of(participant));
  if (!is_new) return;
  if (participant.vendor != kFastDds) {
    on_problem_(other_vendor_problem(domain_, std::exchange(known->second, {}), vendor_name(participant.vendor)));
  } else if (!has_certificate(participant.id)) {
    on_problem_(not_secured_problem(domain_, std::exchange(known->second, {})));
  }
}

void SecurityWatch::refused(const ParticipantId& participant) {
  const std::lock_guard lock(mutex_);
  const auto [known, is_new] = names_.try_emplace(participant, to_string(participant));
  if (known->second.empty()) return;
  const std::string name = std::exchange(known->second, {});
  on_problem_(has_certificate(participant) ? refused_problem(domain_, name) : not_secured_problem(domain_, name));
}

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
