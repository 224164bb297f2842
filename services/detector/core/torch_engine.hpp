// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {

/// Where librtd_engine_torch.so is looked for: this folder if it is set, else beside the program and in
/// ../lib/rtd-slam.
inline constexpr const char* kEngineFolder = "RTD_ENGINE_DIR";

/// Loads libtorch the first time, which takes a second. Throws EngineError when the library is not there or of another
/// version, or its device is not; OnnxGraphError for a network that is not understood.
std::unique_ptr<Engine> make_torch_engine(const EngineModel& model, const std::string& device);

/// Whether libtorch is there and can use a GPU. Does not load it on a host without a driver of NVIDIA.
bool torch_sees_gpu();

/// The devices of libtorch, "1.13.1: cuda:0, cpu"; empty without the library.
std::string torch_devices();

}  // namespace rtd::detector
