// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/ddsrt/log.h>

#include <memory>
#include <mutex>
#include <string>

#include "common/bus/bus_factory.hpp"
#include "common/bus/cyclonedds/entity.hpp"

namespace rtd::bus::cyclonedds {

/// Cyclone has one domain of a number in a process, and one configuration of it: all connections share it, the last one
/// ends it.
struct Domain {
  std::string config;
  Entity entity;
};

/// Throws BusError: refused, with Cyclone's reason, or already there with other settings.
std::shared_ptr<Domain> join_domain(const BusOptions& options);

/// Captures Cyclone's errors while it lives: they say why a call failed. Otherwise Cyclone's warnings and errors go to
/// stderr in short lines, at most ten in ten seconds: it has one for each malformed packet.
class LogCapture {
 public:
  LogCapture() { dds_set_log_sink(note, this); }
  ~LogCapture();
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  /// ": the errors so far", or nothing.
  std::string reason() const;

 private:
  static void note(void* self, const dds_log_data_t* line);

  mutable std::mutex mutex_;  ///< Cyclone logs from any of its threads
  std::string text_;
};

}  // namespace rtd::bus::cyclonedds
