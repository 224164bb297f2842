// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/bus_config.hpp"
#include "services/camera/openni2/openni2_device.hpp"

namespace rtd::launcher {

enum class Verdict { kOk, kWarn, kFail };

/// One line of the doctor; a problem names its fix.
struct Finding {
  Verdict verdict;
  std::string text;
};
using Findings = std::vector<Finding>;

struct DoctorOptions {
  bool clean = false;  ///< only remove what killed processes left in /dev/shm, and list what was removed and what stays
  service::ConfigSources config;  ///< how the services will join the bus
};

/// `rtd doctor`: one line per check (ok, warn, FAIL), each problem with the command that fixes it. Returns 0 when a
/// run can start with these options, 1 when a check failed, 2 when arguments or configuration are wrong (see `err`).
int doctor(const DoctorOptions& options, std::ostream& out, std::ostream& err);

/// With --secure: does the keystore exist, and can every enclave in it join the domain at `now_s`? A host need not have
/// all enclaves. Returns a usable enclave for a test of the bus, preferably the one of the options; empty: none.
std::string check_keystore(const bus::BusOptions& options, std::int64_t now_s, Findings& findings);

/// Checks what the network settings need on this host: interfaces that are up, peers that resolve and are reachable,
/// free UDP ports.
void check_network(const bus::BusOptions& options, Findings& findings);

/// A line for each camera with its modes, or what keeps it from being used; one line when there is none.
void describe_cameras(const std::vector<camera::FoundCamera>& cameras, Findings& findings);

/// The sequence that `rtd demo` plays, and RTD_DATA_DIR when it has it; else empty.
inline constexpr char kDemoSequence[] = "walk_xyz";
std::string demo_data_folder();

/// Why the camera of a source "SCHEME:[DEVICE]" cannot be used now, in the words of the doctor: it is not plugged in,
/// or others are. `device`: its URI or serial number, empty = the first. Empty when it is there.
std::string why_no_camera(const std::string& scheme, const std::string& device,
                          const std::vector<camera::FoundCamera>& cameras);
/// The same of "realsense-dds:[SERIAL]": looks for three seconds for what announces itself on DDS. Throws
/// bus::BusError.
std::string why_no_realsense(const std::string& serial, const bus::BusOptions& options);

}  // namespace rtd::launcher
