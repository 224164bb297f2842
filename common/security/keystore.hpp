// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/security/enclave.hpp"
#include "common/security/permissions.hpp"

namespace rtd::security {

struct KeystoreOptions {
  Validity validity;     ///< of certificates and permissions
  Validity ca_validity;  ///< of the CA
  Governance governance;
};

/// An enclave to be made.
struct EnclaveRequest {
  std::string name;  ///< "/rtd/slam": letters, digits, '_', '-', '.' and '/', at most 64
  TopicGrant topics;
};

/// A new CA with the governance that it signs. Throws SecurityError when the folder holds a keystore or files already.
void create_keystore(const std::string& folder, const KeystoreOptions& options);
/// Adds enclaves, each with a key and certificate of its own and the permissions asked for. Throws SecurityError:
/// one of that name exists, or the CA's key is not in this copy of the keystore. Domains: those of the options.
void add_enclaves(const std::string& folder, const std::vector<EnclaveRequest>& requests, const Validity& validity,
                  const DomainRange& domains);
/// A new key, certificate and permissions for an enclave; topics and domains stay, `more` topics are added.
void renew_enclave(const std::string& folder, const std::string& name, const Validity& validity,
                   const TopicGrant& more);

}  // namespace rtd::security
