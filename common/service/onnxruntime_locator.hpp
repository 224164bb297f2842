// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/service/model_locator.hpp"

namespace rtd::service {

/// Where the library of ONNX Runtime is looked for, in this order: where `deploy/setup.sh --onnxruntime` puts it next
/// to this build, /usr/local/lib/rtd-slam, then the folders of the system's libraries.
std::vector<std::filesystem::path> onnxruntime_folders();

/// The path of ONNX Runtime's library: the value of RTD_ONNXRUNTIME as it is, else the first libonnxruntime.so or, of
/// one with a version (libonnxruntime.so.1.21), the newest in the first folder that has any. Empty: there is none.
std::string find_onnxruntime(const EnvironmentReader& environment, const std::vector<std::filesystem::path>& folders);

/// The same with the environment of this process and onnxruntime_folders().
std::string find_onnxruntime();

}  // namespace rtd::service
