// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {

/// Whether this program was built with ONNX Runtime's C API.
bool knows_onnxruntime();

/// Loads `library`, a libonnxruntime.so, the first time that it is asked for. `device`: "cpu", "cuda" or "cuda:1".
/// Throws EngineError: this program was built without the C API, the library cannot be loaded or is too old, its device
/// is not there, or it does not take the network.
std::unique_ptr<Engine> make_onnxruntime_engine(const EngineModel& model, const std::string& library,
                                                const std::string& device);

}  // namespace rtd::detector
