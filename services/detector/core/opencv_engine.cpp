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

constexpr std::size_t kObjectnessPlane = 4;

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
  OpencvEngine(const EngineModel& model, std::string device, std::optional<cv::ocl::OpenCLExecutionContext> opencl)
      : planes_(model.planes),
        planes_per_anchor_(model.planes_per_anchor),
        gate_(model.min_objectness_logit),
        device_(std::move(device)),
        opencl_(std::move(opencl)) {
    const FastSigmoidScope fast_sigmoid;
    net_ = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(model.onnx.data()), model.onnx.size());
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(opencl_ ? cv::dnn::DNN_TARGET_OPENCL : cv::dnn::DNN_TARGET_CPU);
    for (const cv::String& name : net_.getUnconnectedOutLayersNames()) branches_.push_back(branch_of(name));
    for (const Branch& branch : branches_) layer_names_.push_back(branch.layer);
  }

  const std::string& device() const override { return device_; }
  std::size_t outputs() const override { return branches_.size(); }
  const std::vector<RawHead>& infer(const cv::Mat& blob) override {
    std::optional<cv::ocl::OpenCLExecutionContextScope> device_scope;  // of this thread
    if (opencl_) device_scope.emplace(*opencl_);
    net_.setInput(blob);
    net_.forward(outputs_, layer_names_);
    heads_.clear();
    for (std::size_t i = 0; i < branches_.size(); ++i) heads_.push_back(head_of(branches_[i], outputs_[i]));
    return heads_;
  }

 private:
  /// One output of the network.
  struct Branch {
    std::string layer;                  ///< whose output OpenCV computes: the head's input, or the output itself
    std::optional<PointwiseHead> head;  ///< computed here when the head is a 1x1 convolution
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
    if (!is_pointwise(*convolution) || weights.size[0] != planes_ || static_cast<int>(bias.total()) != planes_)
      return branch;
    branch.layer = inputs[0]->name;
    branch.head.emplace(weights.ptr<float>(), std::vector<float>(bias.begin<float>(), bias.end<float>()),
                        static_cast<std::size_t>(weights.size[1]), static_cast<std::size_t>(planes_per_anchor_));
    return branch;
  }

  RawHead head_of(Branch& branch, const cv::Mat& output) const {
    if (output.dims != 4 || output.type() != CV_32F || !output.isContinuous()) return {};
    RawHead head{output.ptr<float>(), output.size[0], output.size[1], output.size[2], output.size[3]};
    if (!branch.head) return head;
    if (static_cast<std::size_t>(head.planes) != branch.head->channels()) return {};
    const RawHead features = head;
    const auto cells = static_cast<std::size_t>(head.rows) * static_cast<std::size_t>(head.cols);
    head.planes = planes_;
    branch.logits.resize(static_cast<std::size_t>(head.images) * branch.head->planes() * cells);
    head.logits = branch.logits.data();
    for (int image = 0; image < head.images; ++image) {
      branch.head->evaluate(features.of(image), cells, gate_,
                            branch.logits.data() + static_cast<std::size_t>(image) * branch.head->planes() * cells);
    }
    return head;
  }

  const int planes_, planes_per_anchor_;
  const float gate_;
  const std::string device_;
  const std::optional<cv::ocl::OpenCLExecutionContext> opencl_;
  cv::dnn::Net net_;
  std::vector<Branch> branches_;
  std::vector<cv::String> layer_names_;
  std::vector<cv::Mat> outputs_;
  std::vector<RawHead> heads_;
};

}  // namespace

PointwiseHead::PointwiseHead(const float* weights, std::vector<float> bias, std::size_t channels,
                             std::size_t planes_per_anchor)
    : channels_(channels),
      planes_per_anchor_(planes_per_anchor),
      bias_(std::move(bias)),
      weights_(bias_.size() * channels) {
  for (std::size_t plane = 0; plane < bias_.size(); ++plane) {
    const std::size_t anchor = plane / planes_per_anchor, within = plane % planes_per_anchor;
    for (std::size_t c = 0; c < channels; ++c) {
      weights_[(anchor * channels + c) * planes_per_anchor + within] = weights[plane * channels + c];
    }
  }
}

void PointwiseHead::evaluate(const float* features, std::size_t cells, float min_objectness_logit,
                             float* logits) const {
  evaluate_objectness(features, cells, logits);
  for (std::size_t anchor = 0; anchor * planes_per_anchor_ < planes(); ++anchor) {
    float* const anchor_logits = logits + anchor * planes_per_anchor_ * cells;
    const float* const objectness = anchor_logits + kObjectnessPlane * cells;
    for (std::size_t i = 0; i < cells; ++i) {
      if (objectness[i] >= min_objectness_logit) evaluate_cell(features + i, cells, anchor, anchor_logits + i);
    }
  }
}

void PointwiseHead::evaluate_objectness(const float* features, std::size_t cells, float* logits) const {
  for (std::size_t anchor = 0; anchor * planes_per_anchor_ < planes(); ++anchor) {
    const std::size_t plane = anchor * planes_per_anchor_ + kObjectnessPlane;
    float* const objectness = logits + plane * cells;
    std::fill_n(objectness, cells, bias_[plane]);
    for (std::size_t c = 0; c < channels_; ++c) {
      const float weight = weights_[(anchor * channels_ + c) * planes_per_anchor_ + kObjectnessPlane];
      const float* const channel = features + c * cells;
      for (std::size_t i = 0; i < cells; ++i) objectness[i] += weight * channel[i];
    }
  }
}

/// All planes but the objectness of one cell; `features` and `cell_logits` point at its first channel and plane.
void PointwiseHead::evaluate_cell(const float* features, std::size_t cells, std::size_t anchor,
                                  float* cell_logits) const {
  const auto first_bias = bias_.begin() + static_cast<std::ptrdiff_t>(anchor * planes_per_anchor_);
  std::vector<float> sums(first_bias, first_bias + static_cast<std::ptrdiff_t>(planes_per_anchor_));
  for (std::size_t c = 0; c < channels_; ++c) {
    const float feature = features[c * cells];
    const float* const weights = weights_.data() + (anchor * channels_ + c) * planes_per_anchor_;
    for (std::size_t plane = 0; plane < planes_per_anchor_; ++plane) sums[plane] += weights[plane] * feature;
  }
  for (std::size_t plane = 0; plane < planes_per_anchor_; ++plane) {
    if (plane != kObjectnessPlane) cell_logits[plane * cells] = sums[plane];
  }
}

std::unique_ptr<Engine> make_opencv_engine(const EngineModel& model, std::string device,
                                           std::optional<cv::ocl::OpenCLExecutionContext> opencl) {
  return std::make_unique<OpencvEngine>(model, std::move(device), std::move(opencl));
}

}  // namespace rtd::detector
