// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <ostream>
#include <string>

#include "common/camera/frame_source.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"

namespace rtd::eval {

/// As service::report_errors(): exit code 2 for what the user named wrong, else 1.
inline int guarded(const std::string& command, std::ostream& err, const std::function<int()>& work) {
  return service::report_errors<service::ConfigError, camera::SourceError, mcap::RecordingFileError,
                                geometry::TrajectoryError, run_record::RunFileError>(command, err, work);
}

}  // namespace rtd::eval
