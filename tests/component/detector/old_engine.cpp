// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/torch/torch_module.hpp"

#ifdef RTD_HAS_ONNXRUNTIME
#include <onnxruntime_c_api.h>

/// An ONNX Runtime from before the API that is needed.
extern "C" __attribute__((visibility("default"))) const OrtApiBase* OrtGetApiBase() noexcept {
  static constexpr OrtApiBase kBase{[](std::uint32_t) noexcept -> const OrtApi* { return nullptr; },
                                    []() noexcept { return "1.2.0"; }};
  return &kBase;
}
#endif

/// A torch engine of another version of RTD-SLAM.
extern "C" __attribute__((visibility("default"))) const rtd::detector::torch_module::Module* rtd_torch_module() {
  static const rtd::detector::torch_module::Module kModule{0, "0", nullptr, nullptr};
  return &kModule;
}
