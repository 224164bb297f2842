// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/detector/tiny_network.hpp"

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

/// AttributeProto of type INTS.
std::string ints(const std::string& name, const std::vector<int>& values) {
  std::string bytes = bytes_field(1, name);
  for (const int value : values) bytes += number_field(8, value);
  return bytes + number_field(20, 7);
}

struct HeadWeights {
  std::vector<float> weights, biases;
};

HeadWeights head_weights(int channels, int stride, int class_count) {
  const auto kernel = static_cast<std::size_t>(3 * stride * stride);
  HeadWeights head{std::vector<float>(static_cast<std::size_t>(channels) * kernel, 0.0F),
                   std::vector<float>(static_cast<std::size_t>(channels), 0.0F)};
  for (std::size_t i = 0; i < kernel; ++i) head.weights[4 * kernel + i] = 40.0F / static_cast<float>(kernel);
  for (int anchor = 0; anchor < 3; ++anchor) {
    const auto first = static_cast<std::size_t>(anchor * (5 + class_count));
    head.biases[first + 4] = -20.0F;
    head.biases[first + 5] = 20.0F;
  }
  return head;
}

std::string conv_node(const std::string& suffix, int stride) {
  const std::vector<int> square = {stride, stride};
  std::string node = bytes_field(1, "images") + bytes_field(1, "w" + suffix) + bytes_field(1, "b" + suffix);
  node += bytes_field(2, "p" + suffix) + bytes_field(3, "conv" + suffix) + bytes_field(4, "Conv");
  return node + bytes_field(5, ints("kernel_shape", square)) + bytes_field(5, ints("strides", square));
}

}  // namespace

std::string tiny_network_onnx(const TinyNetwork& network) {
  const int channels = 3 * (5 + network.class_count);
  std::string nodes, initializers, outputs;
  for (const int stride : network.strides) {
    const std::string suffix = std::to_string(stride);
    const HeadWeights head = head_weights(channels, stride, network.class_count);
    nodes += bytes_field(1, conv_node(suffix, stride));
    initializers += bytes_field(5, tensor("w" + suffix, {channels, 3, stride, stride}, head.weights));
    initializers += bytes_field(5, tensor("b" + suffix, {channels}, head.biases));
    outputs +=
        bytes_field(12, value_info("p" + suffix, {1, channels, network.height_px / stride, network.width_px / stride}));
  }
  const std::vector<int> size =
      network.fixed_size ? std::vector<int>{1, 3, network.height_px, network.width_px} : std::vector<int>{1, 3, 0, 0};
  std::string graph = nodes + bytes_field(2, "tiny") + initializers;
  graph += bytes_field(11, value_info("images", size)) + outputs;
  std::string model = number_field(1, 6) + bytes_field(7, graph);
  for (const auto& [key, value] : network.metadata)
    model += bytes_field(14, bytes_field(1, key) + bytes_field(2, value));
  return model + bytes_field(8, number_field(2, 11));
}

}  // namespace rtd::test
