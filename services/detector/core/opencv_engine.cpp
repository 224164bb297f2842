// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/opencv_engine.hpp"

#include <algorithm>
#include <opencv2/dnn/all_layers.hpp>
#include <optional>
#include <utility>

#include "services/detector/core/fast_sigmoid.hpp"

namespace rtd::detector {
namespace {

/// A 1x1 convolution of step 1 over all channels, with float weights.
bool is_pointwise(const cv::dnn::ConvolutionLayer& convolution) {
  const auto all_one = [](const std::vector<std::size_t>& sizes) {
    return std::ranges::all_of(sizes, [](std::size_t size) { return size == 1; });
  };
  const cv::Mat& weights = convolution.blobs[0];
  const bool floats = weights.type() == CV_32F && convolution.blobs[1].type() == CV_32F && weights.isContinuous();
  return all_one(convolution.kernel_size) && all_one(convolution.strides) && weights.dims == 4 && floats;
}

class OpencvEngine final : public Engine {
 public:
  OpencvEngine(const EngineModel& model, std::string device) : gated_(model.gated), device_(std::move(device)) {
    const FastSigmoidScope fast_sigmoid;
    net_ = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(model.onnx.data()), model.onnx.size());
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    for (const cv::String& name : net_.getUnconnectedOutLayersNames()) branches_.push_back(branch_of(name));
    for (const Branch& branch : branches_) layer_names_.push_back(branch.layer);
  }

  const std::string& device() const override { return device_; }
  std::size_t outputs() const override { return branches_.size(); }
  const std::vector<RawOutput>& infer(const cv::Mat& blob) override {
    net_.setInput(blob);
    net_.forward(mats_, layer_names_);
    tensors_.clear();
    for (std::size_t i = 0; i < branches_.size(); ++i) tensors_.push_back(output_of(branches_[i], mats_[i]));
    return tensors_;
  }

 private:
  /// One output of the network.
  struct Branch {
    std::string layer;                  ///< whose output OpenCV computes: the head's input, or the output itself
    std::optional<PointwiseHead> head;  ///< computed here when the output is gated and its layer a 1x1 convolution
    std::vector<float> logits;
  };

  /// Looks behind the output for a 1x1 convolution of the right number of planes; OpenCV then stops before it.
  Branch branch_of(const std::string& output_name) {
    Branch branch{output_name, std::nullopt, {}};
    cv::Ptr<cv::dnn::Layer> layer = net_.getLayer(net_.getLayerId(output_name));
    std::vector<cv::Ptr<cv::dnn::Layer>> inputs = net_.getLayerInputs(net_.getLayerId(layer->name));
    while (layer->type == "Identity" && inputs.size() == 1) {
      layer = inputs[0];
      inputs = net_.getLayerInputs(net_.getLayerId(layer->name));
    }
    const auto convolution = layer.dynamicCast<cv::dnn::ConvolutionLayer>();
    if (!convolution || inputs.size() != 1 || convolution->blobs.size() != 2 || inputs[0]->type == "Input")
      return branch;
    const cv::Mat& weights = convolution->blobs[0];
    const cv::Mat& bias = convolution->blobs[1];
    if (!is_pointwise(*convolution) || weights.size[0] != gated_.planes ||
        static_cast<int>(bias.total()) != gated_.planes)
      return branch;
    branch.layer = inputs[0]->name;
    branch.head.emplace(weights.ptr<float>(), std::vector<float>(bias.begin<float>(), bias.end<float>()),
                        static_cast<std::size_t>(weights.size[1]), gated_);
    return branch;
  }

  RawOutput output_of(Branch& branch, const cv::Mat& mat) const {
    if (mat.type() != CV_32F || !mat.isContinuous()) return {};
    RawOutput output{mat.ptr<float>(), {mat.size.p, mat.size.p + mat.dims}};
    if (!branch.head) return output;
    if (mat.dims != 4 || static_cast<std::size_t>(mat.size[1]) != branch.head->channels()) return {};
    const RawOutput features = output;
    const auto cells = static_cast<std::size_t>(mat.size[2]) * static_cast<std::size_t>(mat.size[3]);
    const std::size_t numbers = branch.head->planes() * cells;
    branch.logits.resize(static_cast<std::size_t>(features.images()) * numbers);
    for (int image = 0; image < features.images(); ++image) {
      float* const logits = branch.logits.data() + static_cast<std::size_t>(image) * numbers;
      branch.head->evaluate(features.of(image).data(), cells, logits);
    }
    output.values = branch.logits.data();
    output.shape[1] = static_cast<int>(branch.head->planes());
    return output;
  }

  const GatedOutput gated_;
  const std::string device_;
  cv::dnn::Net net_;
  std::vector<Branch> branches_;
  std::vector<cv::String> layer_names_;
  std::vector<cv::Mat> mats_;
  std::vector<RawOutput> tensors_;
};

}  // namespace

PointwiseHead::PointwiseHead(const float* weights, std::vector<float> bias, std::size_t channels,
                             const GatedOutput& gated)
    : channels_(channels),
      group_planes_(static_cast<std::size_t>(gated.group_planes)),
      gate_plane_(static_cast<std::size_t>(gated.gate_plane)),
      least_(gated.least),
      bias_(std::move(bias)),
      weights_(bias_.size() * channels) {
  for (std::size_t plane = 0; plane < bias_.size(); ++plane) {
    const std::size_t group = plane / group_planes_, within = plane % group_planes_;
    for (std::size_t c = 0; c < channels; ++c) {
      weights_[(group * channels + c) * group_planes_ + within] = weights[plane * channels + c];
    }
  }
}

void PointwiseHead::evaluate(const float* features, std::size_t cells, float* logits) const {
  evaluate_gates(features, cells, logits);
  for (std::size_t group = 0; group * group_planes_ < planes(); ++group) {
    float* const group_logits = logits + group * group_planes_ * cells;
    const float* const gates = group_logits + gate_plane_ * cells;
    for (std::size_t i = 0; i < cells; ++i) {
      if (gates[i] >= least_) evaluate_cell(features + i, cells, group, group_logits + i);
    }
  }
}

void PointwiseHead::evaluate_gates(const float* features, std::size_t cells, float* logits) const {
  for (std::size_t group = 0; group * group_planes_ < planes(); ++group) {
    const std::size_t plane = group * group_planes_ + gate_plane_;
    float* const gates = logits + plane * cells;
    std::fill_n(gates, cells, bias_[plane]);
    for (std::size_t c = 0; c < channels_; ++c) {
      const float weight = weights_[(group * channels_ + c) * group_planes_ + gate_plane_];
      const float* const channel = features + c * cells;
      for (std::size_t i = 0; i < cells; ++i) gates[i] += weight * channel[i];
    }
  }
}

/// All planes but the gate of one cell; `features` and `cell_logits` point at its first channel and plane.
void PointwiseHead::evaluate_cell(const float* features, std::size_t cells, std::size_t group,
                                  float* cell_logits) const {
  const auto first_bias = bias_.begin() + static_cast<std::ptrdiff_t>(group * group_planes_);
  std::vector<float> sums(first_bias, first_bias + static_cast<std::ptrdiff_t>(group_planes_));
  for (std::size_t c = 0; c < channels_; ++c) {
    const float feature = features[c * cells];
    const float* const weights = weights_.data() + (group * channels_ + c) * group_planes_;
    for (std::size_t plane = 0; plane < group_planes_; ++plane) sums[plane] += weights[plane] * feature;
  }
  for (std::size_t plane = 0; plane < group_planes_; ++plane) {
    if (plane != gate_plane_) cell_logits[plane * cells] = sums[plane];
  }
}

std::unique_ptr<Engine> make_opencv_engine(const EngineModel& model, std::string device) {
  return std::make_unique<OpencvEngine>(model, std::move(device));
}

}  // namespace rtd::detector
