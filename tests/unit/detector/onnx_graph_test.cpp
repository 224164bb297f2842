// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/onnx_graph.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <random>

#include "common/service/model_locator.hpp"
#include "tests/support/detector/tiny_network.hpp"

namespace rtd::detector {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

OnnxGraph graph_of(const std::string& bytes) {
  return read_onnx_graph({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

TEST(OnnxGraph, holds_nodes_constants_inputs_and_outputs) {
  const OnnxGraph graph = graph_of(test::tiny_network_onnx({.strides = {8, 16}, .pointwise_heads = true}));
  EXPECT_THAT(graph.inputs, SizeIs(1));
  EXPECT_THAT(graph.outputs, SizeIs(2));
  ASSERT_FALSE(graph.nodes.empty());
  const OnnxNode& first = graph.nodes.front();
  EXPECT_EQ(first.op, "Conv");
  EXPECT_THAT(first.attributes.at("strides").numbers, ElementsAre(8, 8));
  const OnnxTensor& weights = graph.constants.at(first.inputs.at(1));
  EXPECT_TRUE(weights.is_float);
  ASSERT_THAT(weights.shape, SizeIs(4));
  EXPECT_THAT(weights.floats, SizeIs(static_cast<std::size_t>(weights.shape[0] * weights.shape[1] * weights.shape[2] *
                                                              weights.shape[3])));
}

TEST(OnnxGraph, takes_shapes_from_initializers_and_from_nodes) {
  for (const bool by_node : {false, true}) {
    const OnnxGraph graph = graph_of(test::tiny_network_onnx({.reshape = {0, 3, -1}, .reshape_by_node = by_node}));
    std::vector<std::vector<std::int64_t>> shapes;
    for (const auto& [name, constant] : graph.constants) shapes.push_back(constant.ints);
    EXPECT_THAT(shapes, Contains(ElementsAre(0, 3, -1))) << by_node;
  }
}

TEST(OnnxGraph, refuses_what_is_no_graph) {
  EXPECT_THAT([] { graph_of("no model"); }, ThrowsMessage<OnnxGraphError>(HasSubstr("not an ONNX model")));
  std::string bytes = test::tiny_network_onnx({});
  EXPECT_THROW(graph_of(bytes.substr(0, bytes.size() / 2)), OnnxGraphError);
}

/// Bytes from outside are never trusted: reading ends with a graph or a refusal.
TEST(OnnxGraph, survives_changed_bytes) {
  const std::string bytes = test::tiny_network_onnx({.class_count = 1, .strides = {32}});
  std::mt19937 random(3);
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string changed = bytes;
    for (int i = 0; i < 4; ++i)
      changed[random() % std::min<std::size_t>(changed.size(), 600)] = static_cast<char>(random());
    try {
      graph_of(changed);
    } catch (const OnnxGraphError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(OnnxGraph, reads_the_real_networks) {
  for (const auto& [name, nodes] :
       {std::pair("v5lite-e-raw-320x320.onnx", 188), std::pair("v5lite-s-raw-480x640.onnx", 254)}) {
    const service::ModelSearch model = service::find_model(name, service::process_environment());
    if (!model) GTEST_SKIP() << model.message;
    std::ifstream file(model.path, std::ios::binary);
    const OnnxGraph graph = graph_of({std::istreambuf_iterator<char>(file), {}});
    EXPECT_THAT(graph.nodes, SizeIs(static_cast<std::size_t>(nodes))) << name;
    EXPECT_THAT(graph.outputs, ElementsAre("p3", "p4", "p5"));
  }
}

}  // namespace
}  // namespace rtd::detector
