// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/yolo_network.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn/all_layers.hpp>
#include <utility>

#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/fast_sigmoid.hpp"

namespace rtd::detector {
namespace {

constexpr std::size_t kObjectnessPlane = 4;

/// Strides and anchors of YOLOv5 and YOLOv5-Lite as published.
std::vector<HeadLayout> default_heads() {
  return {{8, {{{10, 13}, {16, 30}, {33, 23}}}},
          {16, {{{30, 61}, {62, 45}, {59, 119}}}},
          {32, {{{116, 90}, {156, 198}, {373, 326}}}}};
}

constexpr const char* kFix = "run `deploy/setup.sh --models`, or name another file with detector.model";

[[noreturn]] void fail(const std::string& path, const std::string& cause) {
  throw ModelError("detector model '" + path + "': " + cause + "; " + kFix);
}

std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) fail(path, "there is no such file");
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, "cannot be opened");
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.empty()) fail(path, "is empty");
  return bytes;
}

/// OpenCV logs what it throws; here the exception is enough.
class QuietOpenCv {
 public:
  QuietOpenCv() : saved_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(saved_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel saved_;
};

/// A 1x1 convolution of step 1 over all channels, with float weights.
bool is_pointwise(const cv::dnn::ConvolutionLayer& convolution) {
  const auto all_one = [](const std::vector<std::size_t>& sizes) {
    return std::ranges::all_of(sizes, [](std::size_t size) { return size == 1; });
  };
  const cv::Mat& weights = convolution.blobs[0];
  const bool floats = weights.type() == CV_32F && convolution.blobs[1].type() == CV_32F && weights.isContinuous();
  return all_one(convolution.kernel_size) && all_one(convolution.strides) && weights.dims == 4 && floats;
}

std::string join_shape(std::initializer_list<int> sizes) {
  std::string text;
  for (const int size : sizes) {
    if (!text.empty()) text += 'x';
    text += std::to_string(size);
  }
  return text;
}

}  // namespace

const std::vector<std::string>& coco_class_names() {
  static const std::vector<std::string> names = {
      "person",         "bicycle",    "car",           "motorcycle",    "airplane",     "bus",           "train",
      "truck",          "boat",       "traffic light", "fire hydrant",  "stop sign",    "parking meter", "bench",
      "bird",           "cat",        "dog",           "horse",         "sheep",        "cow",           "elephant",
      "bear",           "zebra",      "giraffe",       "backpack",      "umbrella",     "handbag",       "tie",
      "suitcase",       "frisbee",    "skis",          "snowboard",     "sports ball",  "kite",          "baseball bat",
      "baseball glove", "skateboard", "surfboard",     "tennis racket", "bottle",       "wine glass",    "cup",
      "fork",           "knife",      "spoon",         "bowl",          "banana",       "apple",         "sandwich",
      "orange",         "broccoli",   "carrot",        "hot dog",       "pizza",        "donut",         "cake",
      "chair",          "couch",      "potted plant",  "bed",           "dining table", "toilet",        "tv",
      "laptop",         "mouse",      "remote",        "keyboard",      "cell phone",   "microwave",     "oven",
      "toaster",        "sink",       "refrigerator",  "book",          "clock",        "vase",          "scissors",
      "teddy bear",     "hair drier", "toothbrush"};
  return names;
}

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

struct YoloNetwork::Graph {
  cv::dnn::Net net;
};

YoloNetwork::YoloNetwork(DetectorConfig config) : config_(std::move(config)), graph_(std::make_unique<Graph>()) {
  const QuietOpenCv quiet;
  try {
    load();
    infer(cv::Mat(std::vector<int>{1, 3, input_.height_px, input_.width_px}, CV_32F, cv::Scalar(0)));
  } catch (const cv::Exception& error) {
    fail(config_.model_path, "is broken or not understood by OpenCV (" + std::string(error.err) + ")");
  }
}

YoloNetwork::~YoloNetwork() = default;

void YoloNetwork::load() {
  const std::vector<std::uint8_t> bytes = read_bytes(config_.model_path);
  const OnnxFile file = read_onnx_file(bytes.data(), bytes.size());
  if (!file.has_graph) fail(config_.model_path, "is not an ONNX model, or is cut off");
  complete_config(file);
  input_ = file.input.value_or(InputSize{config_.input_width_px, config_.input_height_px});
  const FastSigmoidScope fast_sigmoid;
  graph_->net = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  graph_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  graph_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  for (const cv::String& name : graph_->net.getUnconnectedOutLayersNames()) branches_.push_back(branch_of(name));
  if (branches_.size() != config_.heads.size()) {
    fail(config_.model_path, "has " + std::to_string(branches_.size()) + " outputs, expected " +
                                 std::to_string(config_.heads.size()) + " (one per stride)");
  }
  for (const Branch& branch : branches_) layer_names_.push_back(branch.layer);
}

/// What is not configured comes from the file's metadata, else from the family's defaults.
void YoloNetwork::complete_config(const OnnxFile& file) {
  const auto metadata = [&file](const char* key) {
    const auto found = file.metadata.find(key);
    return found == file.metadata.end() ? std::string() : found->second;
  };
  if (config_.class_names.empty()) config_.class_names = split_lines(metadata("rtd.class_names"));
  if (config_.class_names.empty()) config_.class_names = coco_class_names();
  if (config_.heads.empty()) config_.heads = parse_heads(metadata("rtd.heads"));
  if (config_.heads.empty()) config_.heads = default_heads();
}

/// Looks behind the output for a 1x1 convolution of the right number of planes; OpenCV then stops before it.
YoloNetwork::Branch YoloNetwork::branch_of(const std::string& output_name) {
  Branch branch{output_name, std::nullopt, {}, {}};
  cv::Ptr<cv::dnn::Layer> layer = graph_->net.getLayer(graph_->net.getLayerId(output_name));
  std::vector<cv::Ptr<cv::dnn::Layer>> inputs = graph_->net.getLayerInputs(graph_->net.getLayerId(layer->name));
  while (layer->type == "Identity" && inputs.size() == 1) {
    layer = inputs[0];
    inputs = graph_->net.getLayerInputs(graph_->net.getLayerId(layer->name));
  }
  const auto convolution = layer.dynamicCast<cv::dnn::ConvolutionLayer>();
  if (!convolution || inputs.size() != 1 || convolution->blobs.size() != 2 || inputs[0]->type == "Input") return branch;
  const cv::Mat& weights = convolution->blobs[0];
  const cv::Mat& bias = convolution->blobs[1];
  const int planes = static_cast<int>(HeadLayout{}.anchors.size()) * planes_per_anchor();
  if (!is_pointwise(*convolution) || weights.size[0] != planes || static_cast<int>(bias.total()) != planes)
    return branch;
  branch.layer = inputs[0]->name;
  branch.head.emplace(weights.ptr<float>(), std::vector<float>(bias.begin<float>(), bias.end<float>()),
                      static_cast<std::size_t>(weights.size[1]), static_cast<std::size_t>(planes_per_anchor()));
  return branch;
}

const std::vector<HeadLogits>& YoloNetwork::infer(const cv::Mat& blob) {
  graph_->net.setInput(blob);
  graph_->net.forward(outputs_, layer_names_);
  if (heads_.empty()) assign_layouts();
  heads_.clear();
  const float gate = objectness_gate(config_.decode);
  for (std::size_t i = 0; i < branches_.size(); ++i) {
    Branch& branch = branches_[i];
    const cv::Mat& output = outputs_[i];
    const std::size_t cells = output.total(2);
    const float* logits = output.ptr<float>();
    if (branch.head) {
      branch.logits.resize(branch.head->planes() * cells);
      branch.head->evaluate(logits, cells, gate, branch.logits.data());
      logits = branch.logits.data();
    }
    heads_.push_back({logits, output.size[2], output.size[3], branch.layout});
  }
  return heads_;
}

/// Gives every output the layout whose stride fits its cells, whatever the order of the outputs.
void YoloNetwork::assign_layouts() {
  std::string shapes;
  for (std::size_t i = 0; i < branches_.size(); ++i) shapes += ' ' + shape_of(i);
  for (const HeadLayout& layout : config_.heads) {
    const std::string wanted = join_shape({1, static_cast<int>(layout.anchors.size()) * planes_per_anchor(),
                                           input_.height_px / layout.stride_px, input_.width_px / layout.stride_px});
    bool found = false;
    for (std::size_t i = 0; i < branches_.size(); ++i) {
      if (shape_of(i) != wanted) continue;
      branches_[i].layout = layout;
      found = true;
    }
    if (!found) {
      fail(config_.model_path, "has outputs of shape" + shapes + ", none is " + wanted + " (stride " +
                                   std::to_string(layout.stride_px) + ", " +
                                   std::to_string(config_.class_names.size()) + " classes)");
    }
  }
}

/// "1x255x60x80"; everything but a float tensor of four dimensions and one image is "unsupported".
std::string YoloNetwork::shape_of(std::size_t index) const {
  const cv::Mat& output = outputs_[index];
  if (output.dims != 4 || output.size[0] != 1 || output.type() != CV_32F || !output.isContinuous())
    return "unsupported";
  const std::optional<PointwiseHead>& head = branches_[index].head;
  if (head && static_cast<std::size_t>(output.size[1]) != head->channels()) return "unsupported";
  return join_shape({1, head ? static_cast<int>(head->planes()) : output.size[1], output.size[2], output.size[3]});
}

}  // namespace rtd::detector
