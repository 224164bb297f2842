// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/participant_security.hpp"

#include <filesystem>

#include "common/security/keystore_layout.hpp"

namespace rtd::bus::cyclonedds {

void map_security(const SecurityOptions& security, const Qos& qos) {
  if (!security.enabled()) return;
  const security::EnclaveFiles files = security::KeystoreLayout{security.keystore}.enclave(security.enclave);
  const auto add = [&qos](const std::string& name, const std::string& value) {
    dds_qset_prop(qos.get(), ("dds.sec." + name).c_str(), value.c_str());
  };
  const auto file = [&add](const std::string& name, const std::filesystem::path& path) {
    add(name, "file:" + std::filesystem::absolute(path).string());
  };
  const auto plugin = [&add](const std::string& name, const std::string& library, const std::string& functions) {
    add(name + ".library.path", library);
    add(name + ".library.init", "init_" + functions);
    add(name + ".library.finalize", "finalize_" + functions);
  };
  plugin("auth", "dds_security_auth", "authentication");
  file("auth.identity_ca", files.identity_ca());
  file("auth.identity_certificate", files.certificate());
  file("auth.private_key", files.key());
  plugin("access", "dds_security_ac", "access_control");
  file("access.permissions_ca", files.permissions_ca());
  file("access.governance", files.governance());
  file("access.permissions", files.permissions());
  plugin("crypto", "dds_security_crypto", "crypto");
}

}  // namespace rtd::bus::cyclonedds
