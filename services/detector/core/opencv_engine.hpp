// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/ocl.hpp>
#include <optional>
#include <string>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {

/// OpenCV's DNN module on the CPU, or on an OpenCL device where `opencl` is given. Throws cv::Exception.
std::unique_ptr<Engine> make_opencv_engine(const EngineModel& model, std::string device,
                                           std::optional<cv::ocl::OpenCLExecutionContext> opencl);

}  // namespace rtd::detector
