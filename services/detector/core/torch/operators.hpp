// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/detector/core/onnx_graph.hpp"
#include "services/detector/core/torch/graph_runner.hpp"

namespace rtd::detector {

/// x * Sigmoid(x), which ONNX writes as two operators.
inline constexpr const char* kSilu = "Silu";

/// The nodes of a graph with each Sigmoid and Mul that make a SiLU in one.
std::vector<OnnxNode> fuse_silu(const OnnxGraph& graph);

/// The operator of a node. Shapes and scales are taken from the constants now. Throws EngineError for one that is not
/// known, naming it.
GraphRunner::Operator make_operator(const OnnxNode& node, const OnnxGraph& graph);

}  // namespace rtd::detector
