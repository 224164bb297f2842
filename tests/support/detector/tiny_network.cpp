// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/detector/tiny_network.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace rtd::test {
namespace {

std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7U) bytes.push_back(static_cast<char>(value | 0x80U));
  bytes.push_back(static_cast<char>(value));
  return bytes;
}
std::string number_field(int field, std::int64_t value) {
  std::string bytes = varint(static_cast<std::uint64_t>(field) << 3U);
  return bytes += varint(static_cast<std::uint64_t>(value));
}
std::string bytes_field(int field, const std::string& body) {
  std::string bytes = varint(static_cast<std::uint64_t>(field) << 3U | 2U);
  bytes += varint(body.size());
  return bytes += body;
}

/// ValueInfoProto of a float tensor; dimension 0 = free.
std::string value_info(const std::string& name, const std::vector<int>& dimensions) {
  std::string shape;
  for (const int dimension : dimensions) {
    shape += bytes_field(1, dimension > 0 ? number_field(1, dimension) : bytes_field(2, "free"));
  }
  const std::string tensor = number_field(1, 1) + bytes_field(2, shape);
  return bytes_field(1, name) + bytes_field(2, bytes_field(1, tensor));
}

/// TensorProto of floats.
std::string tensor(const std::string& name, const std::vector<int>& dimensions, const std::vector<float>& values) {
  std::string bytes;
  for (const int dimension : dimensions) bytes += number_field(1, dimension);
  std::string raw(values.size() * sizeof(float), '\0');
  std::memcpy(raw.data(), values.data(), raw.size());
  return bytes + number_field(2, 1) + bytes_field(8, name) + bytes_field(9, raw);
}

/// TensorProto of 64-bit integers.
std::string shape_tensor(const std::vector<int>& values) {
  std::string packed;
  for (const int value : values) packed += varint(static_cast<std::uint64_t>(std::int64_t{value}));
  return number_field(1, static_cast<std::int64_t>(values.size())) + number_field(2, 7) + bytes_field(7, packed) +
         bytes_field(8, "shape");
}

/// The nodes and initializers of TinyNetwork::reshape.
std::string reshape_fields(const TinyNetwork& network) {
  const std::string tensor = shape_tensor(network.reshape);
  const std::string value = bytes_field(1, "value") + bytes_field(5, tensor) + number_field(20, 4);
  const std::string constant = bytes_field(2, "shape") + bytes_field(4, "Constant") + bytes_field(5, value);
  const std::string node =
      bytes_field(1, "images") + bytes_field(1, "shape") + bytes_field(2, "reshaped") + bytes_field(4, "Reshape");
  return (network.reshape_by_node ? bytes_field(1, constant) : bytes_field(5, tensor)) + bytes_field(1, node);
}

/// AttributeProto of type INTS.
std::string ints(const std::string& name, const std::vector<int>& values) {
  std::string bytes = bytes_field(1, name);
  for (const int value : values) bytes += number_field(8, value);
  return bytes + number_field(20, 7);
}

/// A convolution over whole cells of `cell` px: output 0 = gain * mean of the inputs, the others 0, plus biases.
struct Convolution {
  std::string name, input, output;
  int inputs, outputs, cell;
  float gain;
  int gained_output;  ///< the output that sees the inputs
  std::vector<float> biases;
};

std::string node_of(const Convolution& convolution) {
  const std::vector<int> square = {convolution.cell, convolution.cell};
  std::string node = bytes_field(1, convolution.input) + bytes_field(1, "w" + convolution.name);
  node += bytes_field(1, "b" + convolution.name) + bytes_field(2, convolution.output);
  node += bytes_field(3, "conv" + convolution.name) + bytes_field(4, "Conv");
  return node + bytes_field(5, ints("kernel_shape", square)) + bytes_field(5, ints("strides", square));
}

std::string weights_of(Convolution convolution, const std::function<float(float)>& spoil) {
  const auto kernel = static_cast<std::size_t>(convolution.inputs * convolution.cell * convolution.cell);
  std::vector<float> weights(static_cast<std::size_t>(convolution.outputs) * kernel, 0.0F);
  for (std::size_t i = 0; i < kernel; ++i) {
    weights[static_cast<std::size_t>(convolution.gained_output) * kernel + i] =
        convolution.gain / static_cast<float>(kernel);
  }
  if (spoil) {
    std::transform(weights.begin(), weights.end(), weights.begin(), spoil);
    std::transform(convolution.biases.begin(), convolution.biases.end(), convolution.biases.begin(), spoil);
  }
  const std::vector<int> shape = {convolution.outputs, convolution.inputs, convolution.cell, convolution.cell};
  return bytes_field(5, tensor("w" + convolution.name, shape, weights)) +
         bytes_field(5, tensor("b" + convolution.name, {convolution.outputs}, convolution.biases));
}

Convolution head_convolution(const TinyNetwork& network, int stride) {
  const int channels = 3 * (5 + network.class_count);
  std::vector<float> biases(static_cast<std::size_t>(channels), 0.0F);
  for (int anchor = 0; anchor < 3; ++anchor) {
    const auto first = static_cast<std::size_t>(anchor * (5 + network.class_count));
    biases[first + 4] = -20.0F;
    biases[first + 5] = 20.0F;
  }
  const std::string suffix = std::to_string(stride);
  return {suffix, "images", "p" + suffix, 3, channels, stride, 40.0F, 4, biases};
}

}  // namespace

std::string tiny_network_onnx(const TinyNetwork& network) {
  const int channels = 3 * (5 + network.class_count), batch = network.free_batch ? 0 : 1;
  std::string nodes, initializers, outputs;
  for (const int stride : network.strides) {
    const Convolution head = head_convolution(network, stride);
    nodes += bytes_field(1, node_of(head));
    initializers += weights_of(head, network.spoil);
    const std::vector<int> shape = {batch, channels, network.height_px / stride, network.width_px / stride};
    outputs += bytes_field(12, value_info("p" + std::to_string(stride), shape));
  }
  const bool fixed = network.fixed_size;
  const std::vector<int> size = {batch, 3, fixed ? network.height_px : 0, fixed ? network.width_px : 0};
  std::string graph = nodes + bytes_field(2, "tiny") + initializers;
  graph += bytes_field(11, value_info("images", size)) + outputs;
  if (!network.reshape.empty()) graph += reshape_fields(network);
  std::string model = number_field(1, 6) + bytes_field(7, graph);
  for (const auto& [key, value] : network.metadata)
    model += bytes_field(14, bytes_field(1, key) + bytes_field(2, value));
  return model + bytes_field(8, number_field(2, 11));
}

std::string tiny_mask_network_onnx() {
  const Convolution mean{"m", "images", "mask", 3, 1, 1, 1.0F, 0, {0.0F}};
  const std::string graph = bytes_field(1, node_of(mean)) + bytes_field(2, "tiny mask") + weights_of(mean, {}) +
                            bytes_field(11, value_info("images", {1, 3, 64, 64})) +
                            bytes_field(12, value_info("mask", {1, 1, 64, 64}));
  return number_field(1, 6) + bytes_field(7, graph) + bytes_field(8, number_field(2, 11));
}

}  // namespace rtd::test
