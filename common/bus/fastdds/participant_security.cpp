// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/participant_security.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "common/bus/security_guard.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

std::string vendor_name(const rtps::VendorId_t& id) {
  if (id == rtps::VendorId_t{0x01, 0x10}) return "Cyclone DDS";
  if (id == rtps::VendorId_t{0x01, 0x01}) return "RTI Connext DDS";
  if (id == rtps::VendorId_t{0x01, 0x03}) return "OpenDDS";
  std::ostringstream text;
  text << "another DDS (vendor " << std::hex << int{id[0]} << '.' << int{id[1]} << ')';
  return text.str();
}

std::string name_of(const rtps::ParticipantProxyData& participant) {
  std::ostringstream text;
  if (participant.m_participantName.size() > 0) text << "'" << participant.m_participantName.c_str() << "' ";
  text << participant.m_guid.guidPrefix;
  return text.str();
}

bool has_certificate(const rtps::ParticipantProxyData& participant) {
  return !participant.identity_token_.class_id().empty();
}

}  // namespace

void map_security(const SecurityOptions& security, eprosima::fastdds::dds::DomainParticipantQos& qos) {
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
    const std::size_t at = line.find("/dev/shm/fast");
    if (at == std::string::npos || line.ends_with(" (deleted)")) continue;
    std::error_code not_ours;  // what another user has mapped for us is his
    fs::permissions(line.substr(at), fs::perms::owner_read | fs::perms::owner_write, not_ours);
  }
}

SecurityWatch::SecurityWatch(const BusOptions& options)
    : domain_(options.domain), on_problem_(options.on_problem ? options.on_problem : [](const std::string&) {}) {}

void SecurityWatch::discovered(const rtps::ParticipantDiscoveryInfo& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  const rtps::ParticipantProxyData& participant = info.info;
  const std::lock_guard lock(mutex_);
  if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
    names_.erase(participant.m_guid.guidPrefix);
    return;
  }
  const auto [known, is_new] = names_.try_emplace(participant.m_guid.guidPrefix, name_of(participant));
  if (!is_new) return;
  if (participant.m_VendorId != rtps::c_VendorId_eProsima) {
    on_problem_(other_vendor_problem(domain_, std::exchange(known->second, {}), vendor_name(participant.m_VendorId)));
  } else if (!has_certificate(participant)) {
    on_problem_(not_secured_problem(domain_, std::exchange(known->second, {})));
  }
}

void SecurityWatch::authenticated(const rtps::ParticipantAuthenticationInfo& info) {
  if (info.status == rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT) return;
  const std::lock_guard lock(mutex_);
  std::ostringstream id;
  id << info.guid.guidPrefix;
  const auto [known, is_new] = names_.try_emplace(info.guid.guidPrefix, id.str());
  if (!known->second.empty()) on_problem_(refused_problem(domain_, std::exchange(known->second, {})));
}

}  // namespace rtd::bus::fastdds
