// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector.hpp"

#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "services/detector/core/network_input.hpp"

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

}  // namespace

Detector::Detector(DetectorConfig config) {
  cv::setNumThreads(config.threads);
  network_ = std::make_unique<Network>(std::move(config));
}

std::vector<vision::Detection> Detector::detect(const cv::Mat& color_bgr) {
  if (color_bgr.empty()) return {};
  const cv::Mat image = to_bgr(color_bgr);
  const Letterbox letterbox = fit_letterbox(image.size(), network_->input());
  fill_blob(image, letterbox, network_->input(), network_->pixels(), blob_);
  network_->infer(blob_);
  return boxes_of(0, [&](const Candidate& candidate) { return box_in_frame(candidate, letterbox, image.size()); });
}

std::vector<std::vector<vision::Detection>> Detector::detect_batch(std::span<const cv::Mat> images) {
  if (images.size() > 1 && !network_->free_batch()) {
    throw std::invalid_argument(
        "detector model '" + config().model_path +
        "' takes one image at a time: `yolov5_to_onnx.py --free-batch OLD.onnx NEW.onnx` frees it");
  }
  const InputSize input = input_size();
  batch_.create(std::vector<int>{static_cast<int>(images.size()), 3, input.height_px, input.width_px}, CV_32F);
  std::vector<Letterbox> letterboxes;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].empty()) throw std::invalid_argument("detector: an image of the batch is empty");
    letterboxes.push_back(fit_letterbox(images[i].size(), input));
    cv::Mat blob(std::vector<int>{1, 3, input.height_px, input.width_px}, CV_32F, batch_.ptr(static_cast<int>(i)));
    fill_blob(to_bgr(images[i]), letterboxes.back(), input, network_->pixels(), blob);
  }
  std::vector<std::vector<vision::Detection>> found;
  if (images.empty()) return found;
  network_->infer(batch_);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto box_of = [&](const Candidate& candidate) {
      return box_in_frame(candidate, letterboxes[i], images[i].size());
    };
    found.push_back(boxes_of(static_cast<int>(i), box_of));
  }
  return found;
}

std::vector<vision::Detection> Detector::boxes_of(int image, const BoxInFrame& box_of) const {
  const DetectorConfig& config = network_->config();
  std::vector<vision::Detection> detections;
  for (const Candidate& candidate : suppress_non_maxima(network_->candidates(image), config.decode)) {
    const cv::Rect2f box = box_of(candidate);
    if (box.empty()) continue;
    const std::string& name = config.class_names[static_cast<std::size_t>(candidate.class_index)];
    detections.push_back({name, candidate.score, box.x, box.y, box.width, box.height});
  }
  return detections;
}

}  // namespace rtd::detector
