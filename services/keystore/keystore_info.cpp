// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/keystore/keystore_info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <ostream>

#include "common/security/enclave.hpp"

namespace rtd::keystore {
namespace {

namespace fs = std::filesystem;

std::string advice(const security::EnclaveFiles& files) {
  std::error_code error;
  const fs::perms others = fs::perms::group_all | fs::perms::others_all;
  const bool open = (fs::status(files.key(), error).permissions() & others) != fs::perms::none;
  return open ? fmt::format("; others may read its key: chmod 600 {}", files.key().string()) : std::string();
}

std::string describe(const security::Enclave& enclave) {
  const security::Permissions& permissions = enclave.permissions;
  return fmt::format("ok    {:<16} until {}  domains {}..{}  publishes {}  subscribes {}{}\n", enclave.name,
                     security::to_utc(enclave.valid_until_s()).substr(0, 10), permissions.domains.first,
                     permissions.domains.last, fmt::join(permissions.topics.publish, " "),
                     fmt::join(permissions.topics.subscribe, " "), advice(enclave.files));
}

}  // namespace

bool print_keystore_info(const std::string& folder, std::int64_t now_s, std::ostream& out) {
  const security::KeystoreLayout layout{folder};
  std::error_code error;
  if (!fs::is_directory(layout.enclaves(), error))
    throw security::SecurityError(
        fmt::format("{} is no keystore: make one with 'rtd keystore create {}'", folder, folder));
  out << folder << (fs::exists(layout.ca_key(), error) ? ": with the CA's key (keep it off the robots)\n" : "\n");
  bool all_good = true;
  for (const std::string& name : enclaves_in(layout)) {
    try {
      const int first_domain = security::load_enclave(folder, name).permissions.domains.first;
      out << describe(security::open_enclave(folder, name, first_domain, now_s));
    } catch (const security::SecurityError& problem) {
      out << fmt::format("FAIL  {:<16} {}\n", name, problem.what());
      all_good = false;
    }
  }
  return all_good;
}

}  // namespace rtd::keystore
