// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/security/permissions.hpp"

namespace rtd::security {

/// What one participant needs, as sros2 names it.
struct EnclaveFiles {
  std::filesystem::path folder;
  std::filesystem::path identity_ca() const { return folder / "identity_ca.cert.pem"; }
  std::filesystem::path permissions_ca() const { return folder / "permissions_ca.cert.pem"; }
  std::filesystem::path certificate() const { return folder / "cert.pem"; }
  std::filesystem::path key() const { return folder / "key.pem"; }
  std::filesystem::path governance() const { return folder / "governance.p7s"; }
  std::filesystem::path permissions() const { return folder / "permissions.p7s"; }
  std::filesystem::path permissions_xml() const { return folder / "permissions.xml"; }
};

/// Where things lie in a keystore.
struct KeystoreLayout {
  std::filesystem::path folder;
  std::filesystem::path ca_certificate() const { return folder / "public" / "ca.cert.pem"; }
  std::filesystem::path ca_key() const { return folder / "private" / "ca.key.pem"; }
  std::filesystem::path enclaves() const { return folder / "enclaves"; }
  std::filesystem::path governance() const { return enclaves() / "governance.p7s"; }
  std::filesystem::path governance_xml() const { return enclaves() / "governance.xml"; }
  /// `name` begins with a slash: "/rtd/slam".
  EnclaveFiles enclave(const std::string& name) const { return {enclaves() / name.substr(1)}; }
};

/// Names of the enclaves that exist, in order: "/rtd/camera", ...
std::vector<std::string> enclaves_in(const KeystoreLayout& layout);
/// Throw SecurityError naming the file.
std::string read_text(const std::filesystem::path& file);

/// The keystore when none is named: RTD_KEYSTORE, ROS_SECURITY_KEYSTORE, else rtd/keystore in the user's
/// configuration (XDG_CONFIG_HOME, ~/.config).
std::string default_keystore();

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
