// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/detector/core/engine.hpp"
#include "services/detector/core/onnx_graph.hpp"

/// What the library librtd_engine_torch.so offers. libtorch is large, so it is loaded only where it is asked for.
namespace rtd::detector::torch_module {

/// Changes with everything in this header and in the headers it includes: a library of another version is refused.
inline constexpr int kVersion = 1;

struct Module {
  int version = kVersion;
  const char* libtorch;  ///< its version: "1.13.1"
  /// "cuda:0 (NVIDIA H200)", ..., "cpu".
  std::vector<std::string> (*devices)();
  /// `device`: "cpu", "cuda", "cuda:1", with "/fp16" in half precision. Throws EngineError: no such device, an operator
  /// that is not known.
  std::unique_ptr<Engine> (*create)(const OnnxGraph& graph, const std::string& device, int threads);
};

/// The only symbol of the library.
inline constexpr const char* kEntry = "rtd_torch_module";
using Entry = const Module* (*)();

}  // namespace rtd::detector::torch_module
