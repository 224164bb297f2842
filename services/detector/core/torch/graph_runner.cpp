// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/torch/graph_runner.hpp"

#include <utility>

#include "services/detector/core/engine.hpp"
#include "services/detector/core/torch/operators.hpp"

namespace rtd::detector {

GraphRunner::GraphRunner(const OnnxGraph& graph, const at::TensorOptions& options) : options_(options) {
  if (graph.inputs.size() != 1)
    throw EngineError("the network has " + std::to_string(graph.inputs.size()) + " inputs, expected one image");
  input_ = slot_of(graph.inputs.front());
  for (const OnnxNode& node : fuse_silu(graph)) add_step(node, graph);
  for (const std::string& output : graph.outputs) outputs_.push_back(slot_of(output));
  constants_.resize(slots_.size());
  for (const auto& [name, constant] : graph.constants) {
    const auto slot = slots_.find(name);
    if (slot == slots_.end() || !constant.is_float) continue;
    const at::Tensor here = at::from_blob(const_cast<float*>(constant.floats.data()), constant.shape, at::kFloat);
    constants_[slot->second] = here.to(options_, false, true);
    if (constant.shape.size() == 4)
      constants_[slot->second] = constants_[slot->second].contiguous(at::MemoryFormat::ChannelsLast);
  }
  release_early();
}

std::size_t GraphRunner::slot_of(const std::string& name) {
  return slots_.try_emplace(name, slots_.size()).first->second;
}

/// Only tensors of floats are inputs at run time; the operator has taken the others.
void GraphRunner::add_step(const OnnxNode& node, const OnnxGraph& graph) {
  Step step{make_operator(node, graph), {}, {}, {}};
  for (const std::string& input : node.inputs) {
    const auto constant = graph.constants.find(input);
    const bool taken =
        constant != graph.constants.end() && (!constant->second.is_float || constant->second.floats.empty());
    if (!input.empty() && !taken) step.inputs.push_back(slot_of(input));
  }
  for (const std::string& output : node.outputs) step.outputs.push_back(slot_of(output));
  steps_.push_back(std::move(step));
}

/// From the end: the first reader that is met is the last one.
void GraphRunner::release_early() {
  std::vector<bool> needed(slots_.size(), false);
  for (const std::size_t slot : outputs_) needed[slot] = true;
  for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
    for (const std::size_t slot : step->inputs) {
      if (needed[slot]) continue;
      needed[slot] = true;
      if (!constants_[slot].defined()) step->released.push_back(slot);
    }
  }
}

std::vector<at::Tensor> GraphRunner::run(const at::Tensor& input) const {
  Values values = constants_;
  values[input_] = input;
  for (const Step& step : steps_) {
    Values inputs;
    for (const std::size_t slot : step.inputs) inputs.push_back(values[slot]);
    for (const std::size_t slot : step.released) values[slot].reset();
    Values outputs = step.compute(std::move(inputs));
    for (std::size_t i = 0; i < step.outputs.size() && i < outputs.size(); ++i)
      values[step.outputs[i]] = std::move(outputs[i]);
  }
  Values results;
  for (const std::size_t slot : outputs_) results.push_back(values[slot]);
  return results;
}

}  // namespace rtd::detector
