// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/yolo_network.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core/utils/logger.hpp>
#include <stdexcept>
#include <utility>

#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {
namespace {

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

std::string join_shape(std::initializer_list<int> sizes) {
  std::string text;
  for (const int size : sizes) {
    if (!text.empty()) text += 'x';
    text += std::to_string(size);
  }
  return text;
}

/// "1x255x60x80"; everything but logits of one image is "unsupported".
std::string shape_of(const RawHead& head) {
  if (head.logits == nullptr || head.images != 1) return "unsupported";
  return join_shape({1, head.planes, head.rows, head.cols});
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

YoloNetwork::YoloNetwork(DetectorConfig config) : config_(std::move(config)) {
  const QuietOpenCv quiet;
  try {
    load();
    infer(cv::Mat(std::vector<int>{1, 3, input_.height_px, input_.width_px}, CV_32F, cv::Scalar(0)));
  } catch (const cv::Exception& error) {
    fail(config_.model_path, "is broken or not understood by OpenCV (" + std::string(error.err) + ")");
  }
}

void YoloNetwork::load() {
  const std::vector<std::uint8_t> bytes = read_bytes(config_.model_path);
  const OnnxFile file = read_onnx_file(bytes.data(), bytes.size());
  if (!file.has_graph) fail(config_.model_path, "is not an ONNX model, or is cut off");
  complete_config(file);
  free_batch_ = file.free_batch;
  input_ = file.input.value_or(InputSize{config_.input_width_px, config_.input_height_px});
  const int planes = static_cast<int>(HeadLayout{}.anchors.size()) * planes_per_anchor();
  engine_ = make_engine(parse_engine(config_.engine), {.onnx = bytes,
                                                       .planes = planes,
                                                       .planes_per_anchor = planes_per_anchor(),
                                                       .min_objectness_logit = objectness_gate(config_.decode),
                                                       .threads = config_.threads,
                                                       .kernel_cache = config_.kernel_cache});
  if (engine_->outputs() != config_.heads.size()) {
    fail(config_.model_path, "has " + std::to_string(engine_->outputs()) + " outputs, expected " +
                                 std::to_string(config_.heads.size()) + " (one per stride)");
  }
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

const std::vector<HeadLogits>& YoloNetwork::infer(const cv::Mat& blob) {
  raw_ = &engine_->infer(blob);
  if (layouts_.empty()) assign_layouts(*raw_);
  return heads_of(0);
}

const std::vector<HeadLogits>& YoloNetwork::heads_of(int image) {
  heads_.clear();
  for (std::size_t i = 0; i < raw_->size(); ++i) {
    const RawHead& head = (*raw_)[i];
    if (image >= head.images) throw std::out_of_range("the network has no image " + std::to_string(image));
    heads_.push_back({head.of(image), head.rows, head.cols, layouts_[i]});
  }
  return heads_;
}

/// Gives every output the layout whose stride fits its cells, whatever the order of the outputs.
void YoloNetwork::assign_layouts(const std::vector<RawHead>& raw) {
  std::string shapes;
  for (const RawHead& head : raw) shapes += ' ' + shape_of(head);
  layouts_.resize(raw.size());
  for (const HeadLayout& layout : config_.heads) {
    const std::string wanted = join_shape({1, static_cast<int>(layout.anchors.size()) * planes_per_anchor(),
                                           input_.height_px / layout.stride_px, input_.width_px / layout.stride_px});
    bool found = false;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (shape_of(raw[i]) != wanted) continue;
      layouts_[i] = layout;
      found = true;
    }
    if (!found) {
      fail(config_.model_path, "has outputs of shape" + shapes + ", none is " + wanted + " (stride " +
                                   std::to_string(layout.stride_px) + ", " +
                                   std::to_string(config_.class_names.size()) + " classes)");
    }
  }
}

}  // namespace rtd::detector
