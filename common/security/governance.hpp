// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/security/permissions.hpp"

namespace rtd::security {

/// How the samples of a topic travel. Whoever may publish or subscribe it is checked in any case.
enum class TopicProtection {
  kAccessOnly,  ///< in the clear among those who may: stays in shared memory
  kEncrypt,     ///< encrypted, and what steers the delivery is signed
};

/// The rules of a domain that all its participants share (DDS-Security's governance document): who is not authenticated
/// is not heard, discovery is encrypted.
struct Governance {
  DomainRange domains;
  std::vector<std::string> access_only;  ///< topics of this protection; all others are encrypted
};

std::string to_xml(const Governance& governance);

}  // namespace rtd::security
