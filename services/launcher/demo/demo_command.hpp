// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/service/bus_config.hpp"

namespace rtd::launcher {

/// The command line of `rtd demo`.
struct DemoOptions {
  std::string dataset;  ///< TUM sequence to download; empty: RTD_DATA_DIR's walk_xyz, else the synthetic office
  std::string out_dir = "rtd-demo";
  service::ConfigSources config;
  std::uint64_t frames = 0;
};

/// Runs the same source with filter mode off and rtd, compares both with the ground truth. Returns the exit code.
int demo(const DemoOptions& options);

/// A sequence of the TUM RGB-D benchmark, on the network and on this host.
struct TumDataset {
  std::string url;     ///< of the archive
  std::string folder;  ///< name of the folder in the archive, e.g. rgbd_dataset_freiburg3_walking_xyz
};

/// "fr3_walking_xyz" -> archive and folder below `base_url`. Throws service::ConfigError for other names.
TumDataset tum_dataset(const std::string& name, const std::string& base_url);

/// The folder of the sequence; downloaded (curl) and unpacked (tar) into the user's cache when it is not there yet.
/// RTD_TUM_URL replaces the public address. Throws std::runtime_error with cause and fix.
std::string fetch_tum_dataset(const std::string& name);

}  // namespace rtd::launcher
