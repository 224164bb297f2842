// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/torch/torch_module.hpp"

/// A torch engine of another version of RTD-SLAM.
extern "C" __attribute__((visibility("default"))) const rtd::detector::torch_module::Module* rtd_torch_module() {
  static const rtd::detector::torch_module::Module kModule{0, "0", nullptr, nullptr};
  return &kModule;
}
