// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/doctor/doctor_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "common/security/enclave.hpp"

namespace rtd::launcher {
namespace {

constexpr std::int64_t kDayS = 24 * 3600, kWarnDays = 30;  // as in the services
const std::vector<std::string> kServices = {"/rtd/camera", "/rtd/detector", "/rtd/filter",  "/rtd/slam",
                                            "/rtd/dense",  "/rtd/record",   "/rtd/launcher"};

/// The enclaves that can join; findings about the others.
std::vector<security::Enclave> usable(const bus::BusOptions& options, const std::vector<std::string>& names,
                                      std::int64_t now_s, Findings& findings) {
  std::vector<security::Enclave> good;
  for (const std::string& name : names) {
    try {
      good.push_back(security::open_enclave(options.security.keystore, name, static_cast<int>(options.domain), now_s));
    } catch (const security::SecurityError& error) {
      findings.push_back({Verdict::kFail, std::string("keystore: ") + error.what()});
    }
  }
  return good;
}

void report_missing(const std::vector<std::string>& there, Findings& findings) {
  std::vector<std::string> missing;
  for (const std::string& service : kServices)
    if (std::ranges::count(there, service) == 0) missing.push_back(service);
  if (missing.empty()) return;
  findings.push_back(
      {Verdict::kWarn, fmt::format("keystore: no enclave {}, so it cannot run on this host; if it should, "
                                   "copy it here from the keystore where it was made",
                                   fmt::join(missing, ", "))});
}

}  // namespace

std::string check_keystore(const bus::BusOptions& options, std::int64_t now_s, Findings& findings) {
  const std::string& folder = options.security.keystore;
  const security::KeystoreLayout layout{folder};
  std::error_code error;
  if (!std::filesystem::is_directory(layout.enclaves(), error)) {
    findings.push_back(
        {Verdict::kFail, fmt::format("keystore: {} is not a keystore: make one with 'rtd keystore create "
                                     "{}', or choose another with --keystore",
                                     folder, folder)});
    return {};
  }
  const std::vector<std::string> names = security::enclaves_in(layout);
  const std::vector<security::Enclave> good = usable(options, names, now_s, findings);
  report_missing(names, findings);
  if (good.empty()) {
    findings.push_back({Verdict::kFail, fmt::format("keystore: {} has no enclave that can join DDS domain {}: 'rtd "
                                                    "keystore info {}'",
                                                    folder, options.domain, folder)});
    return {};
  }
  const auto first = std::ranges::min_element(good, {}, &security::Enclave::valid_until_s);
  const std::int64_t days = (first->valid_until_s() - now_s) / kDayS;
  findings.push_back(
      {days < kWarnDays ? Verdict::kWarn : Verdict::kOk,
       fmt::format("keystore: {}, {} enclaves; {} is the first to expire, in {} days{}", folder, good.size(),
                   first->name, days, days < kWarnDays ? fmt::format(": 'rtd keystore renew {}'", folder) : "")});
  const auto requested = std::ranges::find(good, options.security.enclave, &security::Enclave::name);
  return requested != good.end() ? requested->name : good.front().name;
}

}  // namespace rtd::launcher
