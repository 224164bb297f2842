// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/config.hpp"

namespace rtd::recorder {

/// Section `record` of the configuration.
struct ServiceConfig {
  std::vector<std::string> topics{"*"};  ///< shell patterns on DDS or ROS 2 names
  std::string output;                    ///< FILE.mcap or a folder; empty: a folder named after the time
  std::string split;                     ///< "1GB", "60s", ...; empty: one file
  std::string compression = "none";      ///< of chunks
  bool force = false;                    ///< replace an earlier recording
  bool beside = false;                   ///< an earlier recording stays, this one gets the next free name
  bool json = false;                     ///< the final report as JSON on stdout
  int queue_mib = 256;                   ///< what may wait for the disk
  int chunk_kib = 1024;                  ///< a chunk is ended when it has so much
  int chunk_ms = 100;                    ///< or is so old
  int sync_pause_ms = 50;                ///< between two syncs
  int min_free_mib = 64;                 ///< with less space on the disk the recording ends in good order
  int niceness = 5;                      ///< so much the recorder steps back behind those that it listens to
  bool in_place = false;                 ///< takes images from the camera's shared memory instead of having them sent

  void bind(service::ConfigBinder& binder);
};

}  // namespace rtd::recorder
