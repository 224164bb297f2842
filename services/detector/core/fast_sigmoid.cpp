// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/fast_sigmoid.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <opencv2/dnn.hpp>
#include <vector>

namespace rtd::detector {
namespace {

/// exp(x) for |x| <= 87 without branches, so that the compiler vectorises loops over it:
/// x = n ln 2 + r, exp(r) by the polynomial of Cephes' expf, 2^n through the exponent bits.
inline float exp_branchless(float x) {
  constexpr float kRoundToInteger = 12582912.0F;  // 1.5 * 2^23: the sum has no fraction bits left
  constexpr float kLog2OfE = 1.44269504F, kLn2High = 0.693359375F, kLn2Low = -2.12194440e-4F;
  const float shifted = x * kLog2OfE + kRoundToInteger;
  const float n = shifted - kRoundToInteger;
  const float r = x - n * kLn2High - n * kLn2Low;
  float p = 1.9875691500e-4F;
  p = p * r + 1.3981999507e-3F;
  p = p * r + 8.3334519073e-3F;
  p = p * r + 4.1665795894e-2F;
  p = p * r + 1.6666665459e-1F;
  p = p * r + 5.0000001201e-1F;
  p = p * r * r + r + 1.0F;
  const std::int32_t exponent = std::bit_cast<std::int32_t>(shifted) - std::bit_cast<std::int32_t>(kRoundToInteger);
  return p * std::bit_cast<float>((exponent + 127) << 23);
}

class SigmoidLayer : public cv::dnn::Layer {
 public:
  explicit SigmoidLayer(const cv::dnn::LayerParams& params) : Layer(params) {}
  static cv::Ptr<cv::dnn::Layer> create(cv::dnn::LayerParams& params) { return cv::makePtr<SigmoidLayer>(params); }

  void forward(cv::InputArrayOfArrays inputs, cv::OutputArrayOfArrays outputs, cv::OutputArrayOfArrays) override {
    std::vector<cv::Mat> in, out;
    inputs.getMatVector(in);
    outputs.getMatVector(out);
    for (std::size_t i = 0; i < in.size(); ++i) sigmoid(in[i].ptr<float>(), out[i].ptr<float>(), in[i].total());
  }
};

}  // namespace

void sigmoid(const float* in, float* out, std::size_t count) {
  constexpr float kLimit = 87.0F;  // beyond, exp() leaves the range of float
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = 1.0F / (1.0F + exp_branchless(std::min(kLimit, std::max(-kLimit, -in[i]))));
  }
}

/// Of OpenCV's layer types.
static std::mutex registry;

FastSigmoidScope::FastSigmoidScope() : registry_(registry) {
  cv::dnn::LayerFactory::registerLayer("Sigmoid", SigmoidLayer::create);
}
FastSigmoidScope::~FastSigmoidScope() {
  cv::dnn::LayerFactory::unregisterLayer("Sigmoid");
}

}  // namespace rtd::detector
