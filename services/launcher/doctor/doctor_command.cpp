// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/doctor/doctor_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <ostream>
#include <set>

#include "common/bus/host/host_checks.hpp"
#include "common/bus/host/shm_leftovers.hpp"
#include "common/bus/network.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/msg/services.hpp"
#include "common/msg/word_list.hpp"
#include "common/process/executable.hpp"
#include "common/service/command_line.hpp"
#include "common/service/model_locator.hpp"
#include "services/camera/realsense/realsense_device.hpp"
#include "services/detector/core/engine.hpp"

namespace rtd::launcher {
namespace {

constexpr std::array kVerdicts = {"ok   ", "warn ", "FAIL "};  // by Verdict

void check_services(Findings& findings) {
  std::string missing, left_out;
  std::vector<std::string> found;
  for (const msg::NamedService& service : msg::kServices) {
    if (!process::find_executable(service.executable).empty()) {
      found.emplace_back(service.name);
    } else if (service.in_package_of_all) {
      (service.in_every_run ? missing : left_out) += std::string(" ") + service.executable;
    } else {
      findings.push_back({Verdict::kWarn, std::string("services: ") + service.executable + " is not installed; " +
                                              "package rtd-slam-" + service.name + " has it"});
    }
  }
  const std::string cure = "; build them with 'cmake --build <build folder> --target rtd_services'";
  if (!found.empty()) findings.push_back({Verdict::kOk, "services: " + msg::word_list(found, " and ") + " found"});
  if (!missing.empty()) findings.push_back({Verdict::kFail, "services: missing" + missing + cure});
  if (!left_out.empty())
    findings.push_back({Verdict::kWarn, "services: not there, for some options only:" + left_out + cure});
}

/// A missing Discovery Server is noticed only after a while, and so are participants without keys in a secured domain.
std::chrono::milliseconds patience(const bus::BusOptions& options) {
  if (!options.network.discovery_server.empty()) return bus::kServerPatience + std::chrono::milliseconds(500);
  return std::chrono::milliseconds(options.security.enabled() ? 1000 : 0);
}

/// The vendor in use must work; another vendor that does not is a warning.
void check_vendor(Findings& findings, bus::BusOptions options, const std::string& vendor) {
  const bool used = options.vendor == vendor;
  options.vendor = vendor;
  concurrency::BoundedQueue<std::string> problems(64, concurrency::Overflow::kDropOldest);
  options.on_problem = [&problems](const std::string& problem) { problems.push(problem); };
  try {
    const std::shared_ptr<bus::Bus> bus = bus::connect(options);
    findings.push_back({Verdict::kOk, "bus: " + bus->vendor() + " joins domain " + std::to_string(options.domain) +
                                          (used ? "" : " (--dds " + vendor + ")")});
    // Participants without keys do no harm; without its Discovery Server no participant is found.
    const Verdict verdict = options.network.discovery_server.empty() ? Verdict::kWarn : Verdict::kFail;
    std::set<std::string> known;
    for (auto problem = problems.pop_for(patience(options)); problem; problem = problems.pop_for({}))
      if (known.insert(*problem).second) findings.push_back({verdict, "bus: " + *problem});
  } catch (const std::exception& error) {
    findings.push_back({used ? Verdict::kFail : Verdict::kWarn, "bus: " + vendor + ": " + error.what()});
  }
}

void check_vendors(const bus::BusOptions& options, Findings& findings) {
  check_vendor(findings, options, options.vendor);
  const bool bound = options.security.enabled() || !options.network.discovery_server.empty();  // to that vendor
  if (bound) return;
  for (const std::string& vendor : bus::dds_vendors()) {
    if (vendor != options.vendor) check_vendor(findings, options, vendor);
  }
}

void check_host(const bus::BusOptions& options, Findings& findings) {
  const std::vector<std::string> warnings = bus::host_warnings(options);
  for (const std::string& warning : warnings) findings.push_back({Verdict::kWarn, "host: " + warning});
  if (warnings.empty()) findings.push_back({Verdict::kOk, "host: /dev/shm and socket buffers are large enough"});
}

void check_bus(bus::BusOptions options, Findings& findings) {
  check_network(options, findings);
  bool joinable = true;
  if (options.security.enabled()) {
    options.security.enclave = check_keystore(options, std::time(nullptr), findings);
    joinable = !options.security.enclave.empty();
  }
  if (joinable) check_vendors(options, findings);
  check_host(options, findings);
}

std::string mib(std::uint64_t bytes) {
  return std::to_string((bytes + (1U << 20) - 1) >> 20) + " MiB";
}

void check_leftovers(Findings& findings) {
  const bus::CleanReport report = bus::remove_shm_leftovers({.dry_run = true});
  findings.push_back(
      report.removed.empty()
          ? Finding{Verdict::kOk, "shared memory: no leftovers of killed processes"}
          : Finding{Verdict::kWarn, "shared memory: killed processes left " + mib(report.removed_bytes()) + " in " +
                                        std::to_string(report.removed.size()) +
                                        " files behind; 'rtd doctor --clean' or the next service that starts "
                                        "removes them"});
}

void check_weights(Findings& findings) {
  const service::ModelSearch model = service::find_model({}, service::process_environment());
  findings.push_back(
      model ? Finding{Verdict::kOk, "weights: " + model.path + " (" + service::describe_model(model.path) + ")"}
            : Finding{Verdict::kWarn, "weights: " + model.message + "; until then runs use geometry only"});
}

void check_engines(Findings& findings) {
  std::string text = "detector engines: cpu";
  const std::string library = service::find_onnxruntime();
  if (detector::knows_onnxruntime()) text += ", onnxruntime:" + (library.empty() ? "LIBRARY" : library);
  findings.push_back({Verdict::kOk, text});
}

void check_data(Findings& findings) {
  const std::string folder = demo_data_folder();
  findings.push_back({Verdict::kOk, !folder.empty()
                                        ? "data: " + folder
                                        : "data: RTD_DATA_DIR has no folder walk_xyz, so 'rtd demo' uses the synthetic "
                                          "room; 'rtd demo --source tum:FOLDER' a real sequence"});
}

/// Those of this host, and those that announce themselves in the domain where that can be read.
std::vector<camera::FoundCamera> all_cameras(const bus::BusOptions& bus) {
  std::vector<camera::FoundCamera> cameras = camera::find_openni2_cameras();
  try {
    for (camera::FoundCamera& found : camera::find_realsense_cameras(bus)) cameras.push_back(std::move(found));
  } catch (const bus::BusError&) {
    // check_bus() says why the domain cannot be joined
  }
  return cameras;
}

constexpr int kLooksForAnnouncement = 3;  // of a second each, until a camera on DDS announces itself

/// Threads that Fast DDS starts here stay for the process: they must not take the Ctrl-C of the run that follows.
std::string look_for_realsense(const std::string& serial, const bus::BusOptions& options) {
  std::string why;
  bool interrupted = false;
  {
    service::InterruptSignals signals;
    for (int look = 0; look < kLooksForAnnouncement && !interrupted; ++look) {
      why = why_no_camera("realsense-dds", serial, camera::find_realsense_cameras(options));
      if (why.empty()) break;
      interrupted = signals.take() > 0;
    }
  }
  if (interrupted) std::raise(SIGINT);
  return why;
}

int clean(std::ostream& out) {
  const bus::CleanReport report = bus::remove_shm_leftovers();
  for (const bus::ShmFile& file : report.removed) out << "removed  " << file.name << "  " << mib(file.bytes) << '\n';
  for (const bus::ShmFile& file : report.left) out << "left     " << file.name << "  " << file.reason << '\n';
  out << report.removed.size() << " files removed from /dev/shm, " << mib(report.removed_bytes()) << " freed; "
      << report.left.size() << " left\n";
  return service::kOk;
}

int check_all(const DoctorOptions& options, std::ostream& out) {
  if (options.clean) return clean(out);
  const bus::BusOptions bus = service::load_bus_options(options.config, "rtd-doctor");
  Findings findings;
  check_services(findings);
  check_leftovers(findings);
  check_bus(bus, findings);
  check_weights(findings);
  check_engines(findings);
  check_data(findings);
  describe_cameras(all_cameras(bus), findings);
  bool failed = false;
  for (const Finding& finding : findings) {
    out << kVerdicts.at(static_cast<std::size_t>(finding.verdict)) << finding.text << '\n';
    failed = failed || finding.verdict == Verdict::kFail;
  }
  return failed ? service::kRunFailed : service::kOk;
}

}  // namespace

std::string demo_data_folder() {
  const char* const folder = std::getenv("RTD_DATA_DIR");
  std::error_code error;
  return folder != nullptr && std::filesystem::is_directory(std::filesystem::path(folder) / kDemoSequence, error)
             ? folder
             : "";
}

std::string why_no_realsense(const std::string& serial, const bus::BusOptions& options) {
  std::string why = look_for_realsense(serial, options);
  if (why.empty()) return {};
  why += fmt::format("\n  no such camera announces itself on realsense/device-info in DDS domain {}", options.domain);
  return options.network.loopback_only ? why + "; on this host only: --profile lan adds the network" : why;
}

int doctor(const DoctorOptions& options, std::ostream& out, std::ostream& err) {
  return service::report_errors<service::ConfigError>("rtd doctor", err, [&] { return check_all(options, out); });
}

}  // namespace rtd::launcher
