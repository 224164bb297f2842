// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "services/launcher/core/run/record_builder.hpp"

namespace rtd::launcher {

/// The frames of a run in a file without a name in the folder of the run, which the system removes with the process:
/// about 200 bytes a frame, 22 MB an hour at 30 Hz. Not thread-safe.
class FrameFile final : public FrameStore {
 public:
  /// Throws service::ConfigError: no file can be made in the folder.
  explicit FrameFile(const std::string& folder);
  bool append(const run_record::FrameRecord& frame) override;
  std::vector<run_record::FrameRecord> read() override;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  bool full_ = false;
};

}  // namespace rtd::launcher
