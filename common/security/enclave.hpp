// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "common/security/keystore_layout.hpp"
#include "common/security/permissions.hpp"

namespace rtd::security {

/// An enclave whose documents have been checked.
struct Enclave {
  std::string name;
  EnclaveFiles files;
  Permissions permissions;
  Validity certificate_validity;
  /// The earlier end of certificate and permissions.
  std::int64_t valid_until_s() const {
    return std::min(certificate_validity.not_after_s, permissions.validity.not_after_s);
  }
};

/// Everything of an enclave but its dates and domains. Throws SecurityError with cause and fix: keystore or enclave
/// missing, a file unreadable, a certificate of another CA, a document that another CA signed, a key that does not fit.
Enclave load_enclave(const std::string& keystore, const std::string& name);
/// The same, to join `domain` at `now_s`: also what is expired, not valid yet or for other domains.
Enclave open_enclave(const std::string& keystore, const std::string& name, int domain, std::int64_t now_s);

}  // namespace rtd::security
