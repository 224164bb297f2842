// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace rtd::detector {

/// The graph of an ONNX file cannot be used; what() says why.
class OnnxGraphError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A constant. One of the two lists holds its elements, row-major; none for other types than float and int64.
struct OnnxTensor {
  std::vector<std::int64_t> shape;
  std::vector<float> floats;
  std::vector<std::int64_t> ints;
  bool is_float = false;
};

struct OnnxAttribute {
  std::int64_t number = 0;
  float real = 0;
  std::string text;
  std::vector<std::int64_t> numbers;
  std::optional<OnnxTensor> tensor;
};

/// One operator. Inputs and outputs are names of tensors; "" is an input that is left out.
struct OnnxNode {
  std::string op, name;
  std::vector<std::string> inputs, outputs;
  std::map<std::string, OnnxAttribute> attributes;
};

/// Nodes in an order in which they can be computed, as ONNX demands of its files.
struct OnnxGraph {
  std::vector<OnnxNode> nodes;
  std::map<std::string, OnnxTensor> constants;
  std::vector<std::string> inputs;  ///< without constants
  std::vector<std::string> outputs;
};

/// Reads the graph of ONNX bytes. Throws OnnxGraphError: no graph, malformed, a tensor with more or fewer elements than
/// its shape says, a node that uses what no earlier node makes.
OnnxGraph read_onnx_graph(std::span<const std::uint8_t> onnx);

}  // namespace rtd::detector
