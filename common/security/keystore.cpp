// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/keystore.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "common/io/atomic_file.hpp"

namespace rtd::security {

namespace fs = std::filesystem;
namespace {

constexpr unsigned kPublic = 0644, kPrivate = 0600;

void create_folder(const fs::path& folder, fs::perms perms = fs::perms::none) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && perms != fs::perms::none) fs::permissions(folder, perms, error);
  if (error) throw SecurityError(folder.string() + " cannot be created: " + error.message());
}

void write_file(const fs::path& file, const std::string& content, unsigned mode) {
  try {
    io::write_file(file, content, {.mode = mode, .keep_mode = false});
  } catch (const io::IoError& error) {
    throw SecurityError(std::string("cannot write ") + error.what());
  }
}

void link_to(const fs::path& target, const fs::path& link) {
  std::error_code error;
  fs::create_symlink(target.lexically_relative(link.parent_path()), link, error);
  if (error) throw SecurityError(link.string() + " cannot be linked: " + error.message());
}

Identity load_ca(const KeystoreLayout& layout) {
  std::error_code error;
  if (!fs::exists(layout.ca_certificate(), error))
    throw SecurityError("keystore " + layout.folder.string() + ": there is none; make it with 'rtd keystore create " +
                        layout.folder.string() + "'");
  if (!fs::exists(layout.ca_key(), error))
    throw SecurityError(layout.ca_key().string() +
                        " is missing: enclaves can be added and renewed only where the CA's key is");
  return {certificate_from_pem(read_text(layout.ca_certificate()), layout.ca_certificate().string()),
          key_from_pem(read_text(layout.ca_key()), layout.ca_key().string())};
}

void check_name(const std::string& name) {
  constexpr std::size_t kLongest = 64;  // of a common name
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || std::strchr("_-./", c) != nullptr; };
  const bool fits = name.size() > 1 && name.size() <= kLongest && name[0] == '/' && name.back() != '/' &&
                    name.find("..") == std::string::npos && name.find("//") == std::string::npos &&
                    std::all_of(name.begin(), name.end(), allowed);
  if (!fits)
    throw SecurityError("enclave '" + name +
                        "': begin with '/', use letters, digits, '_', '-', '.' and '/', at most 64 characters");
}

/// Key, certificate and permissions; what is there is replaced.
void write_own_files(const EnclaveFiles& files, const std::string& name, Permissions permissions, const Identity& ca) {
  const Identity identity = issue(name, permissions.validity, ca);
  permissions.subject = subject_name(*identity.certificate);
  const std::string xml = to_xml(permissions);
  write_file(files.key(), to_pem(*identity.key), kPrivate);
  write_file(files.certificate(), to_pem(*identity.certificate), kPublic);
  write_file(files.permissions_xml(), xml, kPublic);
  write_file(files.permissions(), sign_document(xml, ca), kPublic);
}

}  // namespace

void create_keystore(const std::string& folder, const KeystoreOptions& options) {
  const KeystoreLayout layout{folder};
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error))
    throw SecurityError(folder + " exists already and is not replaced: take another name, or 'rtd keystore renew " +
                        folder + "'");
  create_folder(layout.ca_certificate().parent_path());
  create_folder(layout.ca_key().parent_path(), fs::perms::owner_all);
  create_folder(layout.enclaves());
  const Identity ca = create_ca("rtdCA", options.ca_validity);
  write_file(layout.ca_key(), to_pem(*ca.key), kPrivate);
  write_file(layout.ca_certificate(), to_pem(*ca.certificate), kPublic);
  for (const std::string role : {"identity_ca", "permissions_ca"}) {  // one CA in both roles, as sros2 has it
    link_to(layout.ca_certificate(), layout.ca_certificate().parent_path() / (role + ".cert.pem"));
    link_to(layout.ca_key(), layout.ca_key().parent_path() / (role + ".key.pem"));
  }
  const std::string xml = to_xml(options.governance);
  write_file(layout.governance_xml(), xml, kPublic);
  write_file(layout.governance(), sign_document(xml, ca), kPublic);
}

void add_enclaves(const std::string& folder, const std::vector<EnclaveRequest>& requests, const Validity& validity,
                  const DomainRange& domains) {
  const KeystoreLayout layout{folder};
  const Identity ca = load_ca(layout);
  for (const EnclaveRequest& request : requests) {
    check_name(request.name);
    if (std::error_code error; fs::exists(layout.enclave(request.name).certificate(), error))
      throw SecurityError(fmt::format("enclave {} exists already; 'rtd keystore renew {} {}' gives it new keys",
                                      request.name, folder, request.name));
  }
  for (const EnclaveRequest& request : requests) {
    const EnclaveFiles files = layout.enclave(request.name);
    create_folder(files.folder);
    link_to(layout.folder / "public" / "identity_ca.cert.pem", files.identity_ca());
    link_to(layout.folder / "public" / "permissions_ca.cert.pem", files.permissions_ca());
    link_to(layout.governance(), files.governance());
    write_own_files(files, request.name, {{}, validity, domains, request.topics}, ca);
  }
}

void renew_enclave(const std::string& folder, const std::string& name, const Validity& validity,
                   const TopicGrant& more) {
  const KeystoreLayout layout{folder};
  const Identity ca = load_ca(layout);
  const EnclaveFiles files = layout.enclave(name);
  const std::string origin = files.permissions().string();
  Permissions permissions = permissions_from_xml(verified_text(read_text(origin), *ca.certificate, origin), origin);
  permissions.validity = validity;
  const auto add = [](std::vector<std::string>& topics, const std::vector<std::string>& further) {
    for (const std::string& topic : further)
      if (std::find(topics.begin(), topics.end(), topic) == topics.end()) topics.push_back(topic);
  };
  add(permissions.topics.publish, more.publish);
  add(permissions.topics.subscribe, more.subscribe);
  write_own_files(files, name, permissions, ca);
}

}  // namespace rtd::security
