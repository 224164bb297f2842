// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "services/detector/core/onnx_file.hpp"
#include "tests/support/detector/tiny_network.hpp"

namespace rtd::detector {
namespace {

using namespace ::testing;

OnnxFile read(const std::string& bytes) {
  return read_onnx_file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TEST(OnnxFile, reads_the_fixed_size) {
  const OnnxFile file = read(test::tiny_network_onnx({.width_px = 96, .height_px = 64}));
  EXPECT_TRUE(file.has_graph);
  ASSERT_TRUE(file.input);
  EXPECT_EQ(file.input->width_px, 96);
  EXPECT_EQ(file.input->height_px, 64);
}

TEST(OnnxFile, reports_a_free_input_size) {
  const OnnxFile file = read(test::tiny_network_onnx({.fixed_size = false}));
  EXPECT_TRUE(file.has_graph);
  EXPECT_FALSE(file.input);
}

TEST(OnnxFile, counts_the_parameters) {
  const OnnxFile file = read(test::tiny_network_onnx({.class_count = 1, .strides = {8}}));
  EXPECT_EQ(file.parameters, 18U * 3 * 8 * 8 + 18);  // 3 x (5 + 1) outputs over 3 channels of 8 x 8 px, and biases
}

TEST(OnnxFile, finds_no_graph_in_other_files) {
  EXPECT_FALSE(read("").has_graph);
  EXPECT_FALSE(read("<html>404 not found</html>").has_graph);
  EXPECT_FALSE(read(std::string(1000, '\0')).has_graph);
  EXPECT_FALSE(read("PK\x03\x04 a zip").has_graph);
}

TEST(OnnxFile, finds_no_graph_in_any_beginning_of_a_model) {
  const std::string bytes = test::tiny_network_onnx({});
  for (std::size_t size = 0; size + 8 < bytes.size(); size += 97) {
    EXPECT_FALSE(read(bytes.substr(0, size)).has_graph) << size << " of " << bytes.size() << " bytes";
  }
}

TEST(OnnxFile, reads_inside_random_bytes_only) {  // the address sanitizer is the judge
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = test::tiny_network_onnx({.width_px = 32,
                                                 .height_px = 32,
                                                 .class_count = 1,
                                                 .free_batch = true,
                                                 .reshape = {0, 3, 1024},
                                                 .reshape_by_node = i % 2 == 0,
                                                 .strides = {32}});
    for (int k = 0; k < 8; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(random() % bytes.size());
    (void)read(bytes);
  }
}

TEST(OnnxFile, says_whether_several_images_fit) {
  EXPECT_FALSE(read(test::tiny_network_onnx({})).free_batch);
  const OnnxFile file = read(test::tiny_network_onnx({.free_batch = true}));
  EXPECT_TRUE(file.free_batch);
  ASSERT_TRUE(file.input);
  EXPECT_EQ(file.input->width_px, 64);
}

TEST(OnnxFile, a_reshape_that_names_the_batch_fixes_it) {
  for (const bool by_node : {false, true}) {
    const auto free_with = [by_node](const std::vector<int>& shape) {
      return read(test::tiny_network_onnx({.free_batch = true, .reshape = shape, .reshape_by_node = by_node}))
          .free_batch;
    };
    EXPECT_TRUE(free_with({0, 3, 4096})) << by_node;
    EXPECT_FALSE(free_with({1, 3, 4096})) << by_node;
    EXPECT_FALSE(free_with({-1, 4096})) << by_node;  // could mix images
  }
}

TEST(OnnxFile, copying_reshapes_do_not_free_a_fixed_input) {
  EXPECT_FALSE(read(test::tiny_network_onnx({.reshape = {0, 3, 4096}})).free_batch);
}

TEST(OnnxFile, the_published_files_take_one_image) {  // their shapes are raw bytes
  const char* const folder = std::getenv("RTD_MODEL_DIR");
  const std::string path = std::string(folder == nullptr ? "/nowhere" : folder) + "/v5lite-e-raw-320x320.onnx";
  std::ifstream stream(path, std::ios::binary);
  if (!stream) GTEST_SKIP() << "no " << path << " (RTD_MODEL_DIR)";
  const OnnxFile file = read({std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()});
  EXPECT_TRUE(file.has_graph);
  EXPECT_FALSE(file.free_batch);
}

TEST(OnnxFile, reads_the_metadata) {
  const OnnxFile file = read(test::tiny_network_onnx({.metadata = {{"rtd.heads", "8: 1,2 3,4 5,6"}, {"empty", ""}}}));
  EXPECT_THAT(file.metadata, ElementsAre(Pair("empty", ""), Pair("rtd.heads", "8: 1,2 3,4 5,6")));
}

TEST(ParseHeads, reads_what_the_converter_writes) {
  const std::vector<HeadLayout> heads = parse_heads("8: 10,13 16,30 33,23\n16: 30.5,61 62,45 59,119");
  ASSERT_THAT(heads, SizeIs(2));
  EXPECT_EQ(heads[0].stride_px, 8);
  EXPECT_FLOAT_EQ(heads[0].anchors[2].width_px, 33.0F);
  EXPECT_EQ(heads[1].stride_px, 16);
  EXPECT_FLOAT_EQ(heads[1].anchors[0].width_px, 30.5F);
  EXPECT_FLOAT_EQ(heads[1].anchors[2].height_px, 119.0F);
}

TEST(ParseHeads, refuses_anything_else) {
  for (const char* text :
       {"", "x", "8", "8:", "8: 10,13 16,30", "0: 1,1 1,1 1,1", "8: 1,2 3,4 5,6 7,8", "8: 1;2 3,4 5,6"}) {
    EXPECT_THAT(parse_heads(text), IsEmpty()) << text;
  }
}

}  // namespace
}  // namespace rtd::detector
