// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <opencv2/dnn.hpp>

#include "common/service/model_locator.hpp"
#include "services/detector/core/fast_sigmoid.hpp"

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

TEST(Network, equals_opencv) {
  const service::ModelSearch model = service::find_model("v5lite-s-raw-480x640.onnx", service::process_environment());
  if (!model) GTEST_SKIP() << model.message;
  DetectorConfig config;
  config.engine = "cpu";
  config.model_path = model.path;
  Network network(config);
  cv::Mat blob(std::vector<int>{1, 3, network.input().height_px, network.input().width_px}, CV_32F);
  cv::RNG(5).fill(blob, cv::RNG::UNIFORM, 0.0, 1.0);

  const std::vector<RawOutput>& heads = network.infer(blob);

  cv::dnn::Net dense = cv::dnn::readNetFromONNX(model.path);
  dense.setInput(blob);
  std::vector<cv::Mat> outputs;
  dense.forward(outputs, dense.getUnconnectedOutLayersNames());
  ASSERT_EQ(heads.size(), outputs.size());
  for (std::size_t i = 0; i < heads.size(); ++i) {
    ASSERT_EQ(heads[i].of(0).size(), outputs[i].total());
    for (std::size_t k = 0; k < outputs[i].total(); ++k)
      ASSERT_NEAR(heads[i].values[k], outputs[i].ptr<float>()[k], 1e-3F) << i << ' ' << k;
  }
}

}  // namespace
}  // namespace rtd::detector
