// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/network.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <opencv2/dnn.hpp>
#include <random>

#include "common/service/model_locator.hpp"
#include "services/detector/core/decoders/yolov5.hpp"
#include "services/detector/core/fast_sigmoid.hpp"
#include "services/detector/core/opencv_engine.hpp"

namespace rtd::detector {
namespace {

TEST(FastSigmoid, is_the_sigmoid) {
  std::vector<float> x, y;
  for (float value = -100.0F; value <= 100.0F; value += 0.0137F) x.push_back(value);
  y.resize(x.size());
  sigmoid(x.data(), y.data(), x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double expected = 1.0 / (1.0 + std::exp(-static_cast<double>(x[i])));
    EXPECT_NEAR(y[i], expected, 1e-6 * expected + 1e-37) << x[i];
  }
}

TEST(FastSigmoid, works_in_place_and_at_the_ends) {
  const float infinity = std::numeric_limits<float>::infinity();
  std::vector<float> values = {0.0F, infinity, -infinity, 1e30F, -1e30F};
  sigmoid(values.data(), values.data(), values.size());
  EXPECT_FLOAT_EQ(values[0], 0.5F);
  EXPECT_FLOAT_EQ(values[1], 1.0F);
  EXPECT_NEAR(values[2], 0.0F, 1e-30F);
  EXPECT_FLOAT_EQ(values[3], 1.0F);
  EXPECT_NEAR(values[4], 0.0F, 1e-30F);
}

TEST(PointwiseHead, computes_what_passes_and_leaves_the_rest) {
  constexpr std::size_t kChannels = 7, kPlanesPerAnchor = 6, kPlanes = 3 * kPlanesPerAnchor, kCells = 50;
  constexpr float kGate = 0.5F, kUntouched = -1234.0F;
  constexpr GatedOutput kGated{.planes = kPlanes, .group_planes = kPlanesPerAnchor, .gate_plane = 4, .least = kGate};
  std::mt19937_64 random(11);
  std::normal_distribution<float> normal;
  const auto draw = [&](std::size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = normal(random);
    return values;
  };
  const std::vector<float> weights = draw(kPlanes * kChannels), bias = draw(kPlanes),
                           features = draw(kChannels * kCells);
  std::vector<float> logits(kPlanes * kCells, kUntouched);

  PointwiseHead(weights.data(), bias, kChannels, kGated).evaluate(features.data(), kCells, logits.data());

  int passed = 0;
  for (std::size_t plane = 0; plane < kPlanes; ++plane) {
    for (std::size_t i = 0; i < kCells; ++i) {
      float expected = bias[plane];
      for (std::size_t c = 0; c < kChannels; ++c) expected += weights[plane * kChannels + c] * features[c * kCells + i];
      const std::size_t objectness_plane = plane / kPlanesPerAnchor * kPlanesPerAnchor + 4;
      const bool computed = plane == objectness_plane || logits[objectness_plane * kCells + i] >= kGate;
      passed += computed && plane != objectness_plane ? 1 : 0;
      EXPECT_NEAR(logits[plane * kCells + i], computed ? expected : kUntouched, 1e-4F) << plane << ' ' << i;
    }
  }
  EXPECT_GT(passed, 50);
}

/// Objectness everywhere and all planes of the cells that pass are those that OpenCV computes. Returns how many pass.
int expect_equal(const RawOutput& head, const cv::Mat& dense, float gate) {
  int passed = 0;
  const int planes_per_anchor = dense.size[1] / 3, cells = head.shape[2] * head.shape[3];
  for (int anchor = 0; anchor < 3; ++anchor) {
    const int first = anchor * planes_per_anchor;
    for (int i = 0; i < cells; ++i) {
      const auto logit = [&](const float* logits, int plane) { return logits[(first + plane) * cells + i]; };
      EXPECT_NEAR(logit(head.values, 4), logit(dense.ptr<float>(), 4), 1e-3F);
      if (logit(head.values, 4) < gate) continue;
      ++passed;
      for (int plane = 0; plane < planes_per_anchor; ++plane) {
        EXPECT_NEAR(logit(head.values, plane), logit(dense.ptr<float>(), plane), 1e-3F);
      }
    }
  }
  return passed;
}

TEST(Network, equals_opencv_computing_everything) {
  const service::ModelSearch model = service::find_model("v5lite-s-raw-480x640.onnx", service::process_environment());
  if (!model) GTEST_SKIP() << model.message;
  DetectorConfig config;
  config.engine = "cpu";
  config.model_path = model.path;
  config.decode.confidence_threshold = config.decode.objectness_threshold = 0.001;
  Network network(config);
  cv::Mat blob(std::vector<int>{1, 3, network.input().height_px, network.input().width_px}, CV_32F);
  cv::RNG(5).fill(blob, cv::RNG::UNIFORM, 0.0, 1.0);

  const std::vector<RawOutput>& heads = network.infer(blob);

  cv::dnn::Net dense = cv::dnn::readNetFromONNX(model.path);
  dense.setInput(blob);
  std::vector<cv::Mat> outputs;
  dense.forward(outputs, dense.getUnconnectedOutLayersNames());
  ASSERT_EQ(heads.size(), outputs.size());
  int passed = 0;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    passed += expect_equal(heads[i], outputs[i], objectness_gate(config.decode));
  }
  EXPECT_GT(passed, 0);
}

}  // namespace
}  // namespace rtd::detector
