// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

}  // namespace rtd::security
