// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/security/certificate.hpp"

namespace rtd::security {

/// DDS domains, both ends included.
struct DomainRange {
  int first = 0, last = 230;  // Cyclone DDS reads no larger number
  bool holds(int domain) const { return first <= domain && domain <= last; }
};

/// DDS names of topics, or patterns as of the shell ("rt/*"), that a participant may publish and subscribe.
struct TopicGrant {
  std::vector<std::string> publish, subscribe;
};
bool matches_any(const std::vector<std::string>& patterns, const std::string& topic);

/// DDS-Security's permissions document of one participant; everything else is denied.
struct Permissions {
  std::string subject;  ///< as subject_name()
  Validity validity;
  DomainRange domains;
  TopicGrant topics;
};

std::string to_xml(const Permissions& permissions);
/// Throws SecurityError naming `origin`.
Permissions permissions_from_xml(const std::string& xml, const std::string& origin);

/// How the samples of a topic travel. Who may publish and subscribe is checked in any case.
enum class TopicProtection {
  kAccessOnly,  ///< not encrypted among permitted participants: stays in shared memory
  kEncrypt,     ///< encrypted, and what steers the delivery is signed
};

/// The rules of a domain that all its participants share (DDS-Security's governance document): participants
/// that are not authenticated are refused, discovery is encrypted.
struct Governance {
  DomainRange domains;
  std::vector<std::string> access_only;  ///< topics of this protection; all others are encrypted
};

std::string to_xml(const Governance& governance);

/// "2026-11-21T20:00:00", UTC.
std::string to_utc(std::int64_t time_s);

}  // namespace rtd::security
