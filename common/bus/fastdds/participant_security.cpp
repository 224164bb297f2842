// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/participant_security.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "common/bus/host/shm_names.hpp"
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

}  // namespace rtd::bus::fastdds
