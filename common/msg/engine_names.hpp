// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::msg {

/// The engines of the detector, as they are written on a command line: for help and error messages.
inline constexpr const char* kEngineNames =
    "cpu, onnxruntime:LIBRARY[@DEVICE] or auto (ONNX Runtime if it is there, else cpu)";

}  // namespace rtd::msg
