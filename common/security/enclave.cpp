// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/enclave.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>

#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/security/certificate.hpp"

namespace rtd::security {

namespace fs = std::filesystem;
namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : value;
}

}  // namespace

std::vector<std::string> enclaves_in(const KeystoreLayout& layout) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(layout.enclaves(), error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename() == "cert.pem")
      names.push_back("/" + fs::relative(entry->path().parent_path(), layout.enclaves()).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string read_text(const fs::path& file) {
  try {
    std::string text = io::read_file(file, io::kKeys);
    if (text.empty()) throw SecurityError(file.string() + " cannot be read: it is empty");
    return text;
  } catch (const io::IoError& error) {
    throw SecurityError(error.what());
  }
}

std::string default_keystore() {
  for (const char* name : {"RTD_KEYSTORE", "ROS_SECURITY_KEYSTORE"}) {
    if (std::string named = variable(name); !named.empty()) return named;
  }
  const std::string config = variable("XDG_CONFIG_HOME");
  return (config.empty() ? variable("HOME") + "/.config" : config) + "/rtd/keystore";
}

namespace fs = std::filesystem;
namespace {

EnclaveFiles find_enclave(const KeystoreLayout& layout, const std::string& name) {
  const std::string folder = layout.folder.string();
  std::error_code error;
  if (!fs::is_directory(layout.enclaves(), error))
    throw SecurityError(
        fmt::format("keystore {}: {}; make one with 'rtd keystore create {}' or name it with --keystore", folder,
                    fs::exists(layout.folder, error) ? "it has no folder enclaves" : "there is none", folder));
  if (name.size() < 2 || name[0] != '/')
    throw SecurityError("enclave '" + name + "': a name such as /rtd/slam begins with a slash");
  const EnclaveFiles files = layout.enclave(name);
  if (!fs::is_directory(files.folder, error))
    throw SecurityError(fmt::format("keystore {} has no enclave {}, only {}; make it with 'rtd keystore add {} {}'",
                                    folder, name, fmt::join(enclaves_in(layout), " "), folder, name));
  return files;
}

/// The identity must be the CA's, the key the identity's.
Certificate check_identity(const EnclaveFiles& files) {
  const std::string certificate_file = files.certificate().string(), ca_file = files.identity_ca().string();
  Certificate certificate = certificate_from_pem(read_text(certificate_file), certificate_file);
  const Certificate ca = certificate_from_pem(read_text(ca_file), ca_file);
  if (!signed_by(*certificate, *ca))
    throw SecurityError(fmt::format("{} ({}) was not issued by the CA of {} ({}): the files come from two keystores",
                                    certificate_file, subject_name(*certificate), ca_file, subject_name(*ca)));
  const Key key = key_from_pem(read_text(files.key()), files.key().string());
  if (!belongs_to(*key, *certificate))
    throw SecurityError(files.key().string() + " is not the key of " + certificate_file);
  return certificate;
}

Permissions check_documents(const EnclaveFiles& files) {
  const std::string ca_file = files.permissions_ca().string();
  const Certificate ca = certificate_from_pem(read_text(ca_file), ca_file);
  verified_text(read_text(files.governance()), *ca, files.governance().string());
  const std::string origin = files.permissions().string();
  return permissions_from_xml(verified_text(read_text(origin), *ca, origin), origin);
}

void check_dates(const Validity& validity, std::int64_t now_s, const std::string& file, const std::string& fix) {
  if (now_s > validity.not_after_s)
    throw SecurityError(fmt::format("{} expired on {} UTC; {}", file, to_utc(validity.not_after_s), fix));
  if (now_s < validity.not_before_s)
    throw SecurityError(fmt::format("{} is valid only from {} UTC on: is the clock of this host right?", file,
                                    to_utc(validity.not_before_s)));
}

}  // namespace

Enclave load_enclave(const std::string& keystore, const std::string& name) {
  Enclave enclave{name, find_enclave({keystore}, name), {}, {}};
  const Certificate certificate = check_identity(enclave.files);
  enclave.certificate_validity = validity_of(*certificate);
  enclave.permissions = check_documents(enclave.files);
  if (enclave.permissions.subject != subject_name(*certificate))
    throw SecurityError(fmt::format("{} is for {}, the certificate next to it for {}",
                                    enclave.files.permissions().string(), enclave.permissions.subject,
                                    subject_name(*certificate)));
  return enclave;
}

Enclave open_enclave(const std::string& keystore, const std::string& name, int domain, std::int64_t now_s) {
  Enclave enclave = load_enclave(keystore, name);
  const std::string fix = fmt::format("renew it with 'rtd keystore renew {} {}'", keystore, name);
  check_dates(enclave.certificate_validity, now_s, enclave.files.certificate().string(), fix);
  check_dates(enclave.permissions.validity, now_s, enclave.files.permissions().string(), fix);
  const DomainRange& domains = enclave.permissions.domains;
  if (!domains.holds(domain))
    throw SecurityError(fmt::format("enclave {} of {} may join domains {}..{}, not {} (--domain)", name, keystore,
                                    domains.first, domains.last, domain));
  return enclave;
}

}  // namespace rtd::security
