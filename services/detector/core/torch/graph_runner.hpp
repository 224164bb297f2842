// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ATen/ATen.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "services/detector/core/onnx_graph.hpp"

namespace rtd::detector {

/// Computes an ONNX graph with libtorch, operator by operator. For one thread.
class GraphRunner {
 public:
  /// Constants go to the device, in the precision of `options`. Throws EngineError naming an operator, or a form of
  /// one, that is not known.
  GraphRunner(const OnnxGraph& graph, const at::TensorOptions& options);

  /// Runs the graph on its only input, which is on the device. Throws c10::Error for shapes that do not fit.
  std::vector<at::Tensor> run(const at::Tensor& input) const;

  using Values = std::vector<at::Tensor>;
  /// Computes the outputs of a node from its inputs, which it may overwrite where nothing else shares their memory.
  using Operator = std::function<Values(Values inputs)>;

 private:
  using Slots = std::vector<std::size_t>;
  struct Step {
    Operator compute;
    Slots inputs, outputs;
    Slots released;  ///< read by no later step
  };

  std::size_t slot_of(const std::string& name);
  void add_step(const OnnxNode& node, const OnnxGraph& graph);
  void release_early();

  at::TensorOptions options_;
  std::map<std::string, std::size_t> slots_;
  Values constants_;  ///< by slot, undefined where a step computes it
  std::vector<Step> steps_;
  std::size_t input_ = 0;
  Slots outputs_;
};

}  // namespace rtd::detector
