// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/person_segmenter.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "services/detector/core/decoder.hpp"
#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/network_input.hpp"
#include "services/detector/core/onnx_file.hpp"

namespace rtd::detector {
namespace {

constexpr const char* kPerson = "person";
constexpr const char* kDecoder = "person_mask";  // in a file's metadata
constexpr double kSamePersonIou = 0.3;           // between two frames

ModelName name_of(const MaskConfig& config) {
  return {"mask model", "detector.mask_model", config.model_path};
}

struct LoadedNetwork {
  std::unique_ptr<Engine> engine;
  InputSize input;
};

LoadedNetwork load(const MaskConfig& config) {
  const ModelName name = name_of(config);
  const std::vector<std::uint8_t> bytes = read_model_file(name);
  const OnnxFile file = read_onnx_file(bytes.data(), bytes.size());
  if (!file.has_graph) name.refuse("is not an ONNX model, or is cut off");
  const auto decoder = file.metadata.find("rtd.decoder");
  if (decoder != file.metadata.end() && decoder->second != kDecoder)
    name.refuse("is a network for '" + decoder->second + "', expected '" + kDecoder + "'");
  if (!file.input) name.refuse("has no image input of a fixed size");
  EngineChoice engine = parse_engine(config.engine);
  if (engine.kind == EngineChoice::Kind::kAuto) engine.library = config.onnxruntime;
  const QuietOpenCv quiet;
  try {
    const EngineModel model{.onnx = bytes, .threads = config.threads};
    return {make_engine(engine, model), *file.input};
  } catch (const cv::Exception& error) {
    name.refuse("is broken or not understood by OpenCV (" + std::string(error.err) + ")");
  }
}

double iou(const cv::Rect2d& a, const cv::Rect2d& b) {
  const double common = (a & b).area(), all = a.area() + b.area() - common;
  return all > 0 ? common / all : 0;
}

/// `outer` after `inner`.
cv::Matx23d chain(const cv::Matx23d& outer, const cv::Matx23d& inner) {
  const cv::Matx33d last(inner(0, 0), inner(0, 1), inner(0, 2), inner(1, 0), inner(1, 1), inner(1, 2), 0, 0, 1);
  return outer * last;
}

/// Stretches one rectangle to another.
cv::Matx23d stretch(const cv::Rect2d& from, const cv::Rect2d& to) {
  const double x = to.width / from.width, y = to.height / from.height;
  return {x, 0, to.x - x * from.x, 0, y, to.y - y * from.y};
}

cv::Rect2d grown(const cv::Rect2d& box, double share) {
  return {box.x - share * box.width, box.y - share * box.height, (1 + 2 * share) * box.width,
          (1 + 2 * share) * box.height};
}

/// Maps pixels of the image (edges, as boxes) to those of the network's input.
cv::Matx23d map_to_input(const cv::Rect2d& box, double growth, cv::Size image, InputSize input) {
  const cv::Rect2d whole(0, 0, image.width, image.height), to(0, 0, input.width_px, input.height_px);
  return stretch(grown(box, growth) & whole, to);
}

/// The same map for indices of pixels: pixel i covers i to i + 1.
cv::Matx23d of_indices(cv::Matx23d map) {
  for (const int row : {0, 1}) map(row, 2) += 0.5 * (map(row, 0) + map(row, 1)) - 0.5;
  return map;
}

/// Between the centres of pixels; the place is in pixels from the corner of the image.
float bilinear(const cv::Mat& image, const cv::Vec2d& place) {
  const double x = std::clamp(place[0] - 0.5, 0.0, image.cols - 1.0);
  const double y = std::clamp(place[1] - 0.5, 0.0, image.rows - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const auto right_share = static_cast<float>(x - left), low_share = static_cast<float>(y - top);
  const float* const high = image.ptr<float>(top);
  const float* const low = image.ptr<float>(std::min(top + 1, image.rows - 1));
  const int right = std::min(left + 1, image.cols - 1);
  return (1 - low_share) * ((1 - right_share) * high[left] + right_share * high[right]) +
         low_share * ((1 - right_share) * low[left] + right_share * low[right]);
}

}  // namespace

PersonSegmenter::PersonSegmenter(MaskConfig config) : config_(std::move(config)) {
  LoadedNetwork network = load(config_);
  *this = PersonSegmenter(std::move(config_), std::move(network.engine), network.input);
}

PersonSegmenter::PersonSegmenter(MaskConfig config, std::unique_ptr<Engine> engine, InputSize input)
    : config_(std::move(config)), engine_(std::move(engine)), input_(input) {
  const QuietOpenCv quiet;
  const std::vector<int> wanted = {1, 1, input.height_px, input.width_px};
  std::vector<RawOutput> outputs;
  try {
    outputs = engine_->infer(cv::Mat(std::vector<int>{1, 3, input.height_px, input.width_px}, CV_32F, cv::Scalar(0)));
  } catch (const cv::Exception& error) {
    name_of(config_).refuse("is broken or not understood by OpenCV (" + std::string(error.err) + ")");
  }
  if (outputs.size() != 1 || outputs.front().shape != wanted) {
    name_of(config_).refuse("is not a network for masks: its outputs are " + shapes_text(outputs) + ", expected " +
                            shapes_text({{nullptr, wanted}}));
  }
}

vision::PersonMasks PersonSegmenter::segment(const cv::Mat& color_bgr, const std::vector<vision::Detection>& detections,
                                             int fresh_at_most) {
  if (!color_bgr.empty() && color_bgr.type() != CV_8UC3)
    throw std::invalid_argument("masks: image type " + cv::typeToString(color_bgr.type()) + " is not 8-bit BGR");
  std::vector<Mask> people;
  if (!color_bgr.empty()) people = largest_people(detections);
  for (Mask& mask : people) take_from_last(mask);
  std::vector<Mask*> waiting;
  for (Mask& mask : people) waiting.push_back(&mask);
  std::ranges::stable_sort(waiting, std::greater(), [](const Mask* mask) {
    return mask->probability.empty() ? std::numeric_limits<int>::max() : mask->age;
  });
  waiting.resize(std::min(waiting.size(), static_cast<std::size_t>(std::max(0, fresh_at_most))));
  for (Mask* mask : waiting) compute(*mask, color_bgr);
  std::erase_if(people, [](const Mask& mask) { return mask.probability.empty(); });
  last_ = std::move(people);
  if (last_.empty()) return {};
  vision::PersonMasks masks{(color_bgr.cols + vision::kMaskStepPx - 1) / vision::kMaskStepPx,
                            (color_bgr.rows + vision::kMaskStepPx - 1) / vision::kMaskStepPx,
                            {}};
  masks.labels.resize(static_cast<std::size_t>(masks.columns) * static_cast<std::size_t>(masks.rows));
  std::vector<float> best(masks.labels.size(), 0);
  for (const Mask& mask : last_) label(mask, masks, best);
  return masks;
}

/// Largest first; without masks yet.
std::vector<PersonSegmenter::Mask> PersonSegmenter::largest_people(
    const std::vector<vision::Detection>& detections) const {
  std::vector<Mask> people;
  for (std::size_t i = 0; i < std::min(detections.size(), vision::kMaxMasks); ++i) {
    const vision::Detection& detection = detections[i];
    if (detection.class_name != kPerson || !(detection.width_px >= 1) || !(detection.height_px >= 1)) continue;
    Mask mask;
    mask.detection = i;
    mask.box_px = {detection.x_px, detection.y_px, detection.width_px, detection.height_px};
    people.push_back(std::move(mask));
  }
  std::ranges::stable_sort(people, std::greater(), [](const Mask& mask) { return mask.box_px.area(); });
  if (people.size() > static_cast<std::size_t>(config_.masks_per_frame))
    people.resize(static_cast<std::size_t>(config_.masks_per_frame));
  return people;
}

/// Moves the last mask of the box that overlaps most with this one.
void PersonSegmenter::take_from_last(Mask& mask) const {
  const auto overlap = [&](const Mask& last) { return iou(last.box_px, mask.box_px); };
  const auto best = std::ranges::max_element(last_, {}, overlap);
  if (best == last_.end() || overlap(*best) < kSamePersonIou) return;
  mask.to_input = chain(best->to_input, stretch(mask.box_px, best->box_px));
  mask.probability = best->probability;
  mask.age = best->age + 1;
}

void PersonSegmenter::compute(Mask& mask, const cv::Mat& color_bgr) {
  const cv::Size size(input_.width_px, input_.height_px);
  mask.to_input = map_to_input(mask.box_px, config_.growth, color_bgr.size(), input_);
  cv::warpAffine(color_bgr, crop_, of_indices(mask.to_input), size, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  fill_blob(crop_, fit_letterbox(size, input_), input_, PixelFormat{}, blob_);
  const float* const values = engine_->infer(blob_).front().of(0).data();
  mask.probability = cv::Mat(size, CV_32F, const_cast<float*>(values)).clone();
  mask.age = 0;
}

/// Labels the places of the box, grown, whose centre is the person's. `best` holds their probabilities.
void PersonSegmenter::label(const Mask& mask, vision::PersonMasks& masks, std::vector<float>& best) const {
  constexpr double kStep = vision::kMaskStepPx;
  const cv::Rect2d area = grown(mask.box_px, config_.growth);
  const auto place = [](double px, int end) { return static_cast<int>(std::clamp(px / kStep, 0.0, double(end))); };
  const int bottom = place(area.y + area.height + kStep, masks.rows),
            right = place(area.x + area.width + kStep, masks.columns);
  for (int row = place(area.y, masks.rows); row < bottom; ++row) {
    for (int column = place(area.x, masks.columns); column < right; ++column) {
      const cv::Vec2d at = mask.to_input * cv::Vec3d((column + 0.5) * kStep, (row + 0.5) * kStep, 1);
      if (at[0] < 0 || at[1] < 0 || at[0] > input_.width_px || at[1] > input_.height_px) continue;
      const float probability = bilinear(mask.probability, at);
      const auto i =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(masks.columns) + static_cast<std::size_t>(column);
      if (probability < static_cast<float>(config_.threshold) || probability <= best[i]) continue;
      best[i] = probability;
      masks.labels[i] = static_cast<std::uint8_t>(mask.detection + 1);
    }
  }
}

}  // namespace rtd::detector
