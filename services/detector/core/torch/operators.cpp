// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/torch/operators.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {
namespace {

using Values = GraphRunner::Values;
using Operator = GraphRunner::Operator;
using Numbers = std::vector<std::int64_t>;

[[noreturn]] void unknown(const OnnxNode& node, const std::string& what) {
  throw EngineError("the torch engine does not know " + what + " of the operator " + node.op +
                    (node.name.empty() ? "" : " (" + node.name + ")"));
}

Numbers numbers_of(const OnnxNode& node, const std::string& name, Numbers otherwise) {
  const auto found = node.attributes.find(name);
  return found == node.attributes.end() ? otherwise : found->second.numbers;
}

std::int64_t number_of(const OnnxNode& node, const std::string& name, std::int64_t otherwise) {
  const auto found = node.attributes.find(name);
  return found == node.attributes.end() ? otherwise : found->second.number;
}

std::string text_of(const OnnxNode& node, const std::string& name, const std::string& otherwise) {
  const auto found = node.attributes.find(name);
  return found == node.attributes.end() ? otherwise : found->second.text;
}

void require_inputs(const OnnxNode& node, std::size_t least, std::size_t most) {
  if (node.inputs.size() < least || node.inputs.size() > most)
    unknown(node, "the form with " + std::to_string(node.inputs.size()) + " inputs");
}

/// The constant that is an input of a node; null when it is left out or not a constant.
const OnnxTensor* constant(const OnnxNode& node, const OnnxGraph& graph, std::size_t input) {
  if (input >= node.inputs.size()) return nullptr;
  const auto found = graph.constants.find(node.inputs[input]);
  return found == graph.constants.end() ? nullptr : &found->second;
}

/// Rows and columns of a kernel, and what is padded at both sides.
struct Window {
  Numbers kernel, strides, dilations, pads;
};

Window window_of(const OnnxNode& node) {
  const Window window{numbers_of(node, "kernel_shape", {}), numbers_of(node, "strides", {1, 1}),
                      numbers_of(node, "dilations", {1, 1}), numbers_of(node, "pads", {0, 0, 0, 0})};
  if (const std::string pad = text_of(node, "auto_pad", "NOTSET"); pad != "NOTSET") unknown(node, "auto_pad " + pad);
  if (window.kernel.size() > 2 || window.strides.size() != 2 || window.dilations.size() != 2 || window.pads.size() != 4)
    unknown(node, "a form that is not of images");
  if (window.pads[0] != window.pads[2] || window.pads[1] != window.pads[3])
    unknown(node, "pads that are not symmetric");
  return window;
}

/// Nothing else can see it when its memory is overwritten.
bool alone(const at::Tensor& tensor) {
  return tensor.use_count() == 1 && tensor.storage().use_count() == 1;
}

Operator convolution(const OnnxNode& node, const OnnxGraph&) {
  require_inputs(node, 2, 3);
  const Window window = window_of(node);
  const std::int64_t groups = number_of(node, "group", 1);
  return [window, groups](Values inputs) -> Values {
    const c10::optional<at::Tensor> bias = inputs.size() > 2 ? c10::make_optional(inputs[2]) : c10::nullopt;
    return {at::conv2d(inputs[0], inputs[1], bias, window.strides, {window.pads[0], window.pads[1]}, window.dilations,
                       groups)};
  };
}

Operator max_pool(const OnnxNode& node, const OnnxGraph&) {
  require_inputs(node, 1, 1);
  const Window window = window_of(node);
  if (window.kernel.size() != 2) unknown(node, "the form without kernel_shape");
  const bool ceil_mode = number_of(node, "ceil_mode", 0) != 0;
  return [window, ceil_mode](Values inputs) -> Values {
    return {at::max_pool2d(inputs[0], window.kernel, window.strides, {window.pads[0], window.pads[1]}, window.dilations,
                           ceil_mode)};
  };
}

/// 0 copies a side, -1 is what remains.
Operator reshape(const OnnxNode& node, const OnnxGraph& graph) {
  require_inputs(node, 2, 2);
  const OnnxTensor* const shape = constant(node, graph, 1);
  if (shape == nullptr || shape->ints.empty()) unknown(node, "a shape that is not constant");
  if (number_of(node, "allowzero", 0) != 0) unknown(node, "allowzero");
  return [sides = shape->ints](Values inputs) -> Values {
    Numbers wanted = sides;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (wanted[i] == 0) wanted[i] = inputs[0].size(static_cast<std::int64_t>(i));
    }
    return {inputs[0].reshape(wanted)};
  };
}

Operator transpose(const OnnxNode& node, const OnnxGraph&) {
  require_inputs(node, 1, 1);
  const Numbers order = numbers_of(node, "perm", {});
  if (order.empty()) unknown(node, "the form without perm");
  return [order](Values inputs) -> Values { return {inputs[0].permute(order)}; };
}

Operator concat(const OnnxNode& node, const OnnxGraph&) {
  const std::int64_t axis = number_of(node, "axis", 0);
  return [axis](Values inputs) -> Values { return {at::cat(inputs, axis)}; };
}

Operator split(const OnnxNode& node, const OnnxGraph& graph) {
  require_inputs(node, 1, 2);
  Numbers sizes = numbers_of(node, "split", {});
  if (const OnnxTensor* const input = constant(node, graph, 1)) sizes = input->ints;
  if (sizes.size() != node.outputs.size()) unknown(node, "the form without sizes");
  return [sizes, axis = number_of(node, "axis", 0)](Values inputs) -> Values {
    return at::split_with_sizes(inputs[0], sizes, axis);
  };
}

/// To the nearest pixel above and to the left.
Operator resize(const OnnxNode& node, const OnnxGraph& graph) {
  const std::string way = text_of(node, "mode", "nearest") + "/" +
                          text_of(node, "coordinate_transformation_mode", "half_pixel") + "/" +
                          text_of(node, "nearest_mode", "round_prefer_floor");
  if (way != "nearest/asymmetric/floor") unknown(node, "the form " + way);
  const OnnxTensor* const scales = constant(node, graph, 2);
  const bool plain =
      scales != nullptr && scales->floats.size() == 4 && scales->floats[0] == 1 && scales->floats[1] == 1;
  if (!plain || scales->floats[2] < 1 || scales->floats[3] < 1) unknown(node, "scales that do not enlarge images");
  return [y = double{scales->floats[2]}, x = double{scales->floats[3]}](Values inputs) -> Values {
    const at::Tensor& image = inputs[0];
    const Numbers size = {static_cast<std::int64_t>(static_cast<double>(image.size(2)) * y),
                          static_cast<std::int64_t>(static_cast<double>(image.size(3)) * x)};
    return {at::upsample_nearest2d(image, size, y, x)};
  };
}

/// A function of each element, in place where it can be.
Operator elementwise(at::Tensor (*copying)(const at::Tensor&), at::Tensor& (*in_place)(at::Tensor&)) {
  return [copying, in_place](Values inputs) -> Values {
    if (!alone(inputs[0])) return {copying(inputs[0])};
    in_place(inputs[0]);
    return inputs;
  };
}

Operator binary(const OnnxNode& node, at::Tensor (*compute)(const at::Tensor&, const at::Tensor&)) {
  require_inputs(node, 2, 2);
  return [compute](Values inputs) -> Values { return {compute(inputs[0], inputs[1])}; };
}

at::Tensor add(const at::Tensor& a, const at::Tensor& b) {
  return at::add(a, b);
}

std::map<std::string, int> count_uses(const OnnxGraph& graph) {
  std::map<std::string, int> uses;
  for (const OnnxNode& node : graph.nodes)
    for (const std::string& input : node.inputs) ++uses[input];
  for (const std::string& output : graph.outputs) ++uses[output];
  return uses;
}

}  // namespace

std::vector<OnnxNode> fuse_silu(const OnnxGraph& graph) {
  const std::map<std::string, int> uses = count_uses(graph);
  std::map<std::string, std::size_t> sigmoid_at;  // its place in `nodes`, by its output
  std::vector<OnnxNode> nodes;
  /// The Sigmoid of x whose only use is its product with x.
  const auto partner = [&](const std::string& x, const std::string& y) {
    const auto sigmoid = sigmoid_at.find(y);
    const bool fits = sigmoid != sigmoid_at.end() && uses.at(y) == 1 && nodes[sigmoid->second].inputs[0] == x;
    return fits ? std::optional(sigmoid->second) : std::nullopt;
  };
  for (const OnnxNode& node : graph.nodes) {
    if (node.op == "Mul" && node.inputs.size() == 2) {
      const auto straight = partner(node.inputs[0], node.inputs[1]), turned = partner(node.inputs[1], node.inputs[0]);
      if (const auto at = straight ? straight : turned) {
        nodes[*at] = {kSilu, node.name, nodes[*at].inputs, node.outputs, {}};
        continue;
      }
    }
    if (node.op == "Sigmoid" && node.inputs.size() == 1) sigmoid_at[node.outputs[0]] = nodes.size();
    nodes.push_back(node);
  }
  return nodes;
}

GraphRunner::Operator make_operator(const OnnxNode& node, const OnnxGraph& graph) {
  using Make = Operator (*)(const OnnxNode&, const OnnxGraph&);
  using Node = const OnnxNode&;
  using Graph = const OnnxGraph&;
  static const std::map<std::string, Make> kKnown = {
      {"Conv", convolution},
      {"MaxPool", max_pool},
      {"Reshape", reshape},
      {"Transpose", transpose},
      {"Concat", concat},
      {"Split", split},
      {"Resize", resize},
      {"Relu", [](Node, Graph) { return elementwise(at::relu, at::relu_); }},
      {"Sigmoid", [](Node, Graph) { return elementwise(at::sigmoid, at::sigmoid_); }},
      {kSilu, [](Node, Graph) { return elementwise(at::silu, at::silu_); }},
      {"Add", [](Node known, Graph) { return binary(known, add); }},
      {"Mul", [](Node known, Graph) { return binary(known, at::mul); }},
      {"Identity", [](Node, Graph) -> Operator { return [](Values inputs) { return inputs; }; }},
  };
  const auto known = kKnown.find(node.op);
  if (known == kKnown.end()) {
    throw EngineError("the torch engine does not know the operator " + node.op +
                      (node.name.empty() ? "" : " (" + node.name + ")"));
  }
  if (node.inputs.empty()) unknown(node, "the form without inputs");
  return known->second(node, graph);
}

}  // namespace rtd::detector
