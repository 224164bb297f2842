// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/doctor/doctor_command.hpp"

#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "common/bus/host_checks.hpp"
#include "common/bus/shm_leftovers.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/exit_code.hpp"
#include "services/detector/core/model_locator.hpp"
#include "services/launcher/process/executable.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;
namespace {

enum class Verdict { kOk, kWarn, kFail };

struct Finding {
  Verdict verdict;
  std::string text;
};
using Findings = std::vector<Finding>;

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOk:
      return "ok   ";
    case Verdict::kWarn:
      return "warn ";
    case Verdict::kFail:
      break;
  }
  return "FAIL ";
}

void check_services(Findings& findings) {
  std::string missing;
  for (const char* service : {"camera", "detector", "filter", "slam", "dense", "record"}) {
    if (find_executable(std::string("rtd-") + service).empty()) missing += std::string(" rtd-") + service;
  }
  if (missing.empty()) {
    findings.push_back({Verdict::kOk, "services: camera, detector, filter, slam, dense and record found"});
  } else {
    findings.push_back(
        {Verdict::kFail, "services: missing" + missing + "; build all of them: cmake --build <build folder>"});
  }
}

/// As the environment says.
bus::BusOptions bus_options() {
  service::BusConfig config;
  service::ConfigBinder binder;
  binder.section("bus", config);
  service::apply_bus_environment(binder);
  return service::to_bus_options(config, "rtd-doctor");
}

/// The vendor in use must work; another one that does not is worth a word.
void check_vendor(Findings& findings, bus::BusOptions options, const std::string& vendor) {
  const bool used = options.vendor == vendor;
  options.vendor = vendor;
  try {
    const std::shared_ptr<bus::Bus> bus = bus::connect(options);
    findings.push_back({Verdict::kOk, "bus: " + bus->vendor() + " joins domain " + std::to_string(options.domain) +
                                          (used ? "" : " (--dds " + vendor + ")")});
  } catch (const std::exception& error) {
    findings.push_back({used ? Verdict::kFail : Verdict::kWarn, "bus: " + vendor + ": " + error.what()});
  }
}

void check_bus(Findings& findings) {
  try {
    const bus::BusOptions options = bus_options();
    check_vendor(findings, options, options.vendor);
    for (const std::string& vendor : bus::dds_vendors()) {
      if (vendor != options.vendor) check_vendor(findings, options, vendor);
    }
    const std::vector<std::string> warnings = bus::host_warnings(options);
    for (const std::string& warning : warnings) findings.push_back({Verdict::kWarn, "host: " + warning});
    if (warnings.empty()) findings.push_back({Verdict::kOk, "host: /dev/shm and socket buffers are large enough"});
  } catch (const std::exception& error) {
    findings.push_back({Verdict::kFail, std::string("bus: ") + error.what()});
  }
}

/// A MiB count for people.
std::string mib(std::uint64_t bytes) {
  return std::to_string((bytes + (1U << 20) - 1) >> 20) + " MiB";
}

void check_leftovers(Findings& findings) {
  const bus::CleanReport report = bus::remove_shm_leftovers({.dry_run = true});
  findings.push_back(
      report.removed.empty()
          ? Finding{Verdict::kOk, "shared memory: no leftovers of killed processes"}
          : Finding{Verdict::kWarn, "shared memory: " + std::to_string(report.removed.size()) + " files, " +
                                        mib(report.removed_bytes()) +
                                        " left by killed processes; 'rtd doctor --clean', or the next service that "
                                        "starts, removes them"});
}

void check_weights(Findings& findings) {
  const detector::ModelSearch model = detector::find_model({}, detector::process_environment());
  findings.push_back(
      model ? Finding{Verdict::kOk, "weights: " + model.path}
            : Finding{Verdict::kWarn, "weights: " + model.message + "; until then runs use geometry only"});
}

void check_data(Findings& findings) {
  const char* folder = std::getenv("RTD_DATA_DIR");
  std::error_code error;
  if (folder != nullptr && fs::is_directory(fs::path(folder) / "walk_xyz", error)) {
    findings.push_back({Verdict::kOk, std::string("data: ") + folder});
  } else {
    findings.push_back({Verdict::kOk,
                        "data: RTD_DATA_DIR names no folder with walk_xyz, 'rtd demo' shows the synthetic room; "
                        "'rtd demo --dataset fr3_walking_xyz' downloads a real sequence"});
  }
}

int clean(std::ostream& out) {
  const bus::CleanReport report = bus::remove_shm_leftovers();
  for (const bus::ShmFile& file : report.removed) out << "removed  " << file.name << "  " << mib(file.bytes) << '\n';
  for (const bus::ShmFile& file : report.left) out << "left     " << file.name << "  " << file.reason << '\n';
  out << report.removed.size() << " files removed from /dev/shm, " << mib(report.removed_bytes()) << " freed; "
      << report.left.size() << " left\n";
  return service::kOk;
}

}  // namespace

int doctor(const DoctorOptions& options, std::ostream& out) {
  if (options.clean) return clean(out);
  Findings findings;
  check_services(findings);
  check_leftovers(findings);
  check_bus(findings);
  check_weights(findings);
  check_data(findings);
  bool failed = false;
  for (const Finding& finding : findings) {
    out << to_string(finding.verdict) << finding.text << '\n';
    failed = failed || finding.verdict == Verdict::kFail;
  }
  return failed ? service::kRunFailed : service::kOk;
}

}  // namespace rtd::launcher
