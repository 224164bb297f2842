// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <onnxruntime_c_api.h>

#include <cstdint>

/// An ONNX Runtime from before the API that is needed.
extern "C" __attribute__((visibility("default"))) const OrtApiBase* OrtGetApiBase() noexcept {
  static constexpr OrtApiBase kBase{[](std::uint32_t) noexcept -> const OrtApi* { return nullptr; },
                                    []() noexcept { return "1.2.0"; }};
  return &kBase;
}
