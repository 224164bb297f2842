// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/ddsrt/log.h>

#include <mutex>
#include <string>

namespace rtd::bus::cyclonedds {

/// From now on Cyclone's warnings and errors go to stderr in short lines, and only so many in ten seconds: it has one
/// for each malformed packet.
void limit_log();

/// While it lives, Cyclone's errors come here instead: they say why a call failed. Then the limit holds again.
class LogCapture {
 public:
  LogCapture() { dds_set_log_sink(note, this); }
  ~LogCapture() { limit_log(); }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  /// ": what it said", or nothing.
  std::string reason() const;

 private:
  static void note(void* self, const dds_log_data_t* line);

  mutable std::mutex mutex_;  ///< Cyclone logs from any of its threads
  std::string text_;
};

}  // namespace rtd::bus::cyclonedds
