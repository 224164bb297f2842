// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <ostream>

#include "common/camera/frame_source.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/process/out_folder.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"

namespace rtd::eval {

using process::make_out_folder;

/// Runs `work`, which returns an exit code. What it throws becomes a line "<command>: <reason>" and an exit code: 2 for
/// what the user named wrong, else 1.
int guarded(const char* command, std::ostream& err, const auto& work) {
  const auto refuse = [&](const std::exception& error, service::ExitCode code) {
    err << command << ": " << error.what() << '\n';
    return code;
  };
  try {
    return work();
  } catch (const service::ConfigError& error) {
    return refuse(error, service::kUsageOrConfig);
  } catch (const camera::SourceError& error) {
    return refuse(error, service::kUsageOrConfig);
  } catch (const mcap::RecordingFileError& error) {
    return refuse(error, service::kUsageOrConfig);
  } catch (const geometry::TrajectoryError& error) {
    return refuse(error, service::kUsageOrConfig);
  } catch (const run_record::RunFileError& error) {
    return refuse(error, service::kUsageOrConfig);
  } catch (const std::exception& error) {
    return refuse(error, service::kRunFailed);
  }
}

}  // namespace rtd::eval
