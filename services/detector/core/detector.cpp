// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "services/detector/core/coco_classes.hpp"
#include "services/detector/core/letterbox.hpp"
#include "services/detector/core/yolo_decoder.hpp"

namespace rtd::detector {
namespace {

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

std::string shape_text(const cv::Mat& blob) {
  std::string text;
  for (int i = 0; i < blob.dims; ++i) {
    if (i > 0) text += 'x';
    text += std::to_string(blob.size[i]);
  }
  return text;
}

cv::Mat to_bgr(const cv::Mat& image) {
  cv::Mat bgr = image;
  switch (image.type()) {
    case CV_8UC3:
      break;
    case CV_8UC1:
      cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
      break;
    case CV_8UC4:
      cv::cvtColor(image, bgr, cv::COLOR_BGRA2BGR);
      break;
    default:
      throw std::invalid_argument("detector: image type " + cv::typeToString(image.type()) +
                                  " is not 8-bit BGR, BGRA or grey");
  }
  return bgr;
}

}  // namespace

/// The loaded network: frame in, logits of the heads out.
class Detector::Network {
 public:
  explicit Network(DetectorConfig config) : config_(std::move(config)) {
    const QuietOpenCv quiet;
    try {
      load();
      warm_up();
    } catch (const cv::Exception& error) {
      fail(config_.model_path, "is broken or not understood by OpenCV (" + std::string(error.err) + ")");
    }
  }

  const std::vector<HeadLogits>& infer(const cv::Mat& color_bgr, const Letterbox& letterbox) {
    fill_blob(color_bgr, letterbox, input_, blob_);
    forward();
    return heads_;
  }
  InputSize input() const { return input_; }
  const DetectorConfig& config() const { return config_; }

 private:
  void load() {
    const std::vector<std::uint8_t> bytes = read_bytes(config_.model_path);
    const OnnxFile file = read_onnx_file(bytes.data(), bytes.size());
    if (!file.has_graph) fail(config_.model_path, "is no ONNX model, or cut off");
    complete_config(file);
    input_ = file.input.value_or(InputSize{config_.input_width_px, config_.input_height_px});
    net_ = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    output_names_ = net_.getUnconnectedOutLayersNames();
    if (output_names_.size() != config_.heads.size()) {
      fail(config_.model_path, "has " + std::to_string(output_names_.size()) + " outputs, expected " +
                                   std::to_string(config_.heads.size()) + " (one per stride)");
    }
  }

  /// What is not configured comes from the file's metadata, else from the family's defaults.
  void complete_config(const OnnxFile& file) {
    const auto metadata = [&file](const char* key) {
      const auto found = file.metadata.find(key);
      return found == file.metadata.end() ? std::string() : found->second;
    };
    if (config_.class_names.empty()) config_.class_names = split_lines(metadata("rtd.class_names"));
    if (config_.class_names.empty()) config_.class_names = coco_class_names();
    if (config_.heads.empty()) config_.heads = parse_heads(metadata("rtd.heads"));
    if (config_.heads.empty()) config_.heads = default_heads();
  }

  void warm_up() {
    const cv::Mat black = cv::Mat::zeros(input_.height_px, input_.width_px, CV_8UC3);
    fill_blob(black, fit_letterbox(black.size(), input_), input_, blob_);
    forward();
  }

  void forward() {
    net_.setInput(blob_);
    net_.forward(outputs_, output_names_);
    heads_.clear();
    for (const HeadLayout& layout : config_.heads) heads_.push_back(head_of(layout));
  }

  /// The output whose cells have the layout's stride, whatever the order of the file's outputs.
  HeadLogits head_of(const HeadLayout& layout) const {
    const int rows = input_.height_px / layout.stride_px, cols = input_.width_px / layout.stride_px;
    const int planes = static_cast<int>(layout.anchors.size() * (5 + config_.class_names.size()));
    std::string shapes;
    for (const cv::Mat& output : outputs_) {
      if (output.dims == 4 && output.size[0] == 1 && output.size[1] == planes && output.size[2] == rows &&
          output.size[3] == cols && output.type() == CV_32F && output.isContinuous()) {
        return {output.ptr<float>(), rows, cols, layout};
      }
      shapes += ' ';
      shapes += shape_text(output);
    }
    fail(config_.model_path, "has outputs of shape" + shapes + ", none is 1x" + std::to_string(planes) + "x" +
                                 std::to_string(rows) + "x" + std::to_string(cols) + " (stride " +
                                 std::to_string(layout.stride_px) + ", " + std::to_string(config_.class_names.size()) +
                                 " classes)");
  }

  DetectorConfig config_;
  InputSize input_;
  cv::dnn::Net net_;
  std::vector<cv::String> output_names_;
  cv::Mat blob_;
  std::vector<cv::Mat> outputs_;
  std::vector<HeadLogits> heads_;
};

namespace {

/// Input pixels to frame pixels, clipped to the frame.
vision::Detection to_detection(const Candidate& candidate, const Letterbox& letterbox, cv::Size frame,
                               const std::vector<std::string>& class_names) {
  const auto to_x_px = [&](float x_px) {
    return static_cast<float>(std::clamp((x_px - letterbox.pad_left_px) / letterbox.scale_x, 0.0, double(frame.width)));
  };
  const auto to_y_px = [&](float y_px) {
    return static_cast<float>(std::clamp((y_px - letterbox.pad_top_px) / letterbox.scale_y, 0.0, double(frame.height)));
  };
  const float left_px = to_x_px(candidate.left_px), top_px = to_y_px(candidate.top_px);
  return {class_names[static_cast<std::size_t>(candidate.class_index)],
          candidate.score,
          left_px,
          top_px,
          to_x_px(candidate.right_px) - left_px,
          to_y_px(candidate.bottom_px) - top_px};
}

}  // namespace

Detector::Detector(DetectorConfig config) {
  cv::setNumThreads(config.threads);
  network_ = std::make_unique<Network>(std::move(config));
}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

std::vector<vision::Detection> Detector::detect(const cv::Mat& color_bgr) {
  if (color_bgr.empty()) return {};
  const cv::Mat image = to_bgr(color_bgr);
  const Letterbox letterbox = fit_letterbox(image.size(), network_->input());
  const std::vector<HeadLogits>& heads = network_->infer(image, letterbox);
  const DetectorConfig& config = network_->config();
  const int class_count = static_cast<int>(config.class_names.size());
  const std::vector<Candidate> kept =
      suppress_non_maxima(decode_heads(heads, class_count, config.decode), config.decode);
  std::vector<vision::Detection> detections;
  for (const Candidate& candidate : kept) {
    const vision::Detection detection = to_detection(candidate, letterbox, image.size(), config.class_names);
    if (detection.width_px > 0 && detection.height_px > 0) detections.push_back(detection);
  }
  return detections;
}

InputSize Detector::input_size() const {
  return network_->input();
}
const DetectorConfig& Detector::config() const {
  return network_->config();
}

}  // namespace rtd::detector
