// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "services/detector/core/network_input.hpp"
#include "services/detector/core/yolo_decoder.hpp"
#include "services/detector/core/yolo_network.hpp"

namespace rtd::detector {
namespace {

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
  network_ = std::make_unique<YoloNetwork>(std::move(config));
}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

std::vector<vision::Detection> Detector::detect(const cv::Mat& color_bgr) {
  if (color_bgr.empty()) return {};
  const cv::Mat image = to_bgr(color_bgr);
  const Letterbox letterbox = fit_letterbox(image.size(), network_->input());
  fill_blob(image, letterbox, network_->input(), blob_);
  std::vector<vision::Detection> detections;
  for (const Candidate& candidate : find_in_blob()) {
    const vision::Detection detection =
        to_detection(candidate, letterbox, image.size(), network_->config().class_names);
    if (detection.width_px > 0 && detection.height_px > 0) detections.push_back(detection);
  }
  return detections;
}

std::vector<vision::Detection> Detector::detect_upright(const cv::Mat& color_bgr, double roll_rad) {
  if (roll_rad == 0 || color_bgr.empty()) return detect(color_bgr);
  const cv::Mat image = to_bgr(color_bgr);
  const UprightView view = fit_upright(image.size(), network_->input(), roll_rad);
  fill_upright_blob(image, view, blob_);
  std::vector<vision::Detection> detections;
  for (const Candidate& candidate : find_in_blob()) {
    const cv::Rect2f box = box_in_frame(candidate, view);
    if (box.empty()) continue;
    const std::string& name = network_->config().class_names[static_cast<std::size_t>(candidate.class_index)];
    detections.push_back({name, candidate.score, box.x, box.y, box.width, box.height});
  }
  return detections;
}

std::vector<Candidate> Detector::find_in_blob() {
  const DetectorConfig& config = network_->config();
  const int class_count = static_cast<int>(config.class_names.size());
  return suppress_non_maxima(decode_heads(network_->infer(blob_), class_count, config.decode), config.decode);
}

InputSize Detector::input_size() const {
  return network_->input();
}
const DetectorConfig& Detector::config() const {
  return network_->config();
}

}  // namespace rtd::detector
