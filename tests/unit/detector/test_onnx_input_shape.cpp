// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <random>
#include <string>

#include "services/detector/core/onnx_input_shape.hpp"
#include "tests/support/detector/tiny_network.hpp"

namespace rtd::detector {
namespace {

OnnxInput read(const std::string& bytes) {
  return read_onnx_input(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TEST(OnnxInput, reads_the_fixed_size) {
  const OnnxInput input = read(test::tiny_network_onnx({.width_px = 96, .height_px = 64}));
  EXPECT_TRUE(input.has_graph);
  ASSERT_TRUE(input.fixed);
  EXPECT_EQ(input.fixed->width_px, 96);
  EXPECT_EQ(input.fixed->height_px, 64);
}

TEST(OnnxInput, says_when_the_size_is_free) {
  const OnnxInput input = read(test::tiny_network_onnx({.fixed_size = false}));
  EXPECT_TRUE(input.has_graph);
  EXPECT_FALSE(input.fixed);
}

TEST(OnnxInput, finds_no_graph_in_other_files) {
  EXPECT_FALSE(read("").has_graph);
  EXPECT_FALSE(read("<html>404 not found</html>").has_graph);
  EXPECT_FALSE(read(std::string(1000, '\0')).has_graph);
  EXPECT_FALSE(read("PK\x03\x04 a zip").has_graph);
}

TEST(OnnxInput, finds_no_graph_in_any_beginning_of_a_model) {
  const std::string bytes = test::tiny_network_onnx({});
  for (std::size_t size = 0; size + 8 < bytes.size(); size += 97) {
    EXPECT_FALSE(read(bytes.substr(0, size)).has_graph) << size << " of " << bytes.size() << " bytes";
  }
}

TEST(OnnxInput, reads_inside_random_bytes_only) {  // the address sanitizer is the judge
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = test::tiny_network_onnx({.width_px = 32, .height_px = 32, .class_count = 1, .strides = {32}});
    for (int k = 0; k < 8; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(random() % bytes.size());
    (void)read(bytes);
  }
}

}  // namespace
}  // namespace rtd::detector
